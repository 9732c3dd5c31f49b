//! A film of a simulated body's motion, by a camera that follows it.

use super::camera::{Camera, FOLLOW};
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

/// How much further the camera is for each metre of the way from the middle to who is farthest.
const WIDE: f32 = 1.4;

/// A motion before a camera, a frame at a time.
pub struct BodyFilm<'a> {
    model: &'a Arc<Model>,
    motion: &'a MotionClip,
    frame: usize,
    camera: Camera,
    /// From the camera to a single body, m.
    near: f32,
    renderer: Renderer,
    target: RenderTarget,
}

impl<'a> BodyFilm<'a> {
    /// The motion's first frame, in pictures of `size` pixels.
    pub fn new(
        gpu: &Gpu,
        model: &'a Arc<Model>,
        motion: &'a MotionClip,
        camera: Camera,
        size: [u32; 2],
    ) -> BodyFilm<'a> {
        let mut film = BodyFilm {
            model,
            motion,
            frame: 0,
            near: camera.distance,
            camera,
            renderer: Renderer::new(gpu),
            target: RenderTarget::new(&gpu.setup.device, size),
        };
        film.follow(1.0);
        film
    }

    /// Goes on by so many frames; the last one stays.
    pub fn skip(&mut self, frames: usize) {
        for _ in 0..frames {
            self.frame = (self.frame + 1).min(self.motion.frames - 1);
            self.follow(FOLLOW);
        }
    }

    fn follow(&mut self, by: f32) {
        let poses = shapes::poses(self.model, self.motion.q(self.frame));
        let (at, side) = shapes::company(self.model, &poses);
        self.camera.follow([at.x, at.z], by);
        self.camera.distance = self.near + WIDE * side;
    }

    /// The frame, RGB.
    ///
    /// # Errors
    /// The GPU was lost.
    pub fn picture(&mut self) -> Result<Vec<u8>> {
        let poses = shapes::poses(self.model, self.motion.q(self.frame));
        let mut scene = Scene::default();
        shapes::draw(&mut scene, self.model, &poses, Vec3::ZERO, Look::Solid);
        self.renderer.draw(&scene, None, &self.camera, &self.target);
        self.target
            .read(&self.renderer.device, &self.renderer.queue)
    }
}
