//! A film of motion matching under a policy, by a camera that follows the character.

use super::camera::{Camera, FOLLOW};
use super::debug_draw::scene;
use super::film::Film;
use super::render_target::RenderTarget;
use super::renderer::Renderer;
use crate::gpu::Gpu;
use crate::nn::Policy;
use crate::train::playthrough::{Playthrough, PlaythroughContext};
use anyhow::Result;

/// A playthrough before a camera.
pub struct LocomotionFilm {
    context: PlaythroughContext,
    policy: Policy,
    playthrough: Playthrough,
    camera: Camera,
    renderer: Renderer,
    target: RenderTarget,
}

impl LocomotionFilm {
    /// The start of an episode, in pictures of `size` pixels.
    pub fn new(
        gpu: &Gpu,
        context: PlaythroughContext,
        policy: Policy,
        episode: usize,
        camera: Camera,
        size: [u32; 2],
    ) -> LocomotionFilm {
        let mut film = LocomotionFilm {
            playthrough: Playthrough::new(&context, episode),
            policy,
            context,
            camera,
            renderer: Renderer::new(gpu),
            target: RenderTarget::new(&gpu.setup.device, size),
        };
        film.camera.follow(film.playthrough.shown.at, 1.0);
        film
    }
}

impl Film for LocomotionFilm {
    fn skip(&mut self, frames: usize) -> Result<()> {
        for _ in 0..frames {
            self.playthrough.advance(&self.context, &self.policy)?;
            self.camera.follow(self.playthrough.shown.at, FOLLOW);
        }
        Ok(())
    }

    fn picture(&mut self) -> Result<Vec<u8>> {
        let scene = scene(&self.playthrough, &self.context);
        self.renderer.draw(&scene, None, &self.camera, &self.target);
        self.target
            .read(&self.renderer.device, &self.renderer.queue)
    }
}
