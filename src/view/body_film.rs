//! A film of a simulated body's motion, by a camera that follows it.

use super::bout_bars;
use super::camera::{Camera, FOLLOW};
use super::film::Film;
use super::recorded_bout::RecordedBout;
use super::render_target::RenderTarget;
use super::renderer::Renderer;
use super::scene::Scene;
use super::shapes::{self, Look};
use crate::gpu::Gpu;
use crate::physics::model::Model;
use crate::physics::motion_clip::MotionClip;
use anyhow::Result;
use glam::Vec3;
use std::sync::Arc;

/// A motion before a camera, a frame at a time.
pub struct BodyFilm<'a> {
    model: &'a Arc<Model>,
    motion: &'a MotionClip,
    /// What it was besides, if it was a bout.
    bout: Option<&'a RecordedBout>,
    frame: usize,
    camera: Camera,
    renderer: Renderer,
    target: RenderTarget,
}

impl<'a> BodyFilm<'a> {
    /// The motion's first frame, in pictures of `size` pixels.
    pub fn new(
        gpu: &Gpu,
        model: &'a Arc<Model>,
        motion: &'a MotionClip,
        bout: Option<&'a RecordedBout>,
        camera: Camera,
        size: [u32; 2],
    ) -> BodyFilm<'a> {
        let mut film = BodyFilm {
            model,
            motion,
            bout,
            frame: 0,
            camera,
            renderer: Renderer::new(gpu),
            target: RenderTarget::new(&gpu.setup.device, size),
        };
        film.follow(1.0);
        film
    }

    fn follow(&mut self, by: f32) {
        let poses = shapes::poses(self.model, self.motion.q(self.frame));
        let (at, side) = shapes::company(self.model, &poses);
        let aspect = self.target.aspect();
        self.camera.frame([at.x, at.z], side, aspect, by);
    }
}

impl Film for BodyFilm<'_> {
    /// The last frame stays.
    fn skip(&mut self, frames: usize) -> Result<()> {
        for _ in 0..frames {
            self.frame = (self.frame + 1).min(self.motion.frames - 1);
            self.follow(FOLLOW);
        }
        Ok(())
    }

    fn picture(&mut self) -> Result<Vec<u8>> {
        let poses = shapes::poses(self.model, self.motion.q(self.frame));
        let mut scene = Scene::default();
        shapes::draw(&mut scene, self.model, &poses, Vec3::ZERO, Look::Solid);
        if let Some(bout) = self.bout {
            bout.draw(&mut scene, self.frame);
        }
        self.renderer.draw(&scene, None, &self.camera, &self.target);
        let (device, queue) = (&self.renderer.device, &self.renderer.queue);
        let mut rgb = self.target.read(device, queue)?;
        if let Some(bout) = self.bout {
            bout_bars::draw(&mut rgb, self.target.size, bout.at(self.frame));
        }
        Ok(rgb)
    }
}
