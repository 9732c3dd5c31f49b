//! Films of what a task's policies do in a fixed episode, small enough to be looked at while they learn.

use super::body_film::BodyFilm;
use super::camera::Camera;
use super::film::gif;
use super::locomotion_film::LocomotionFilm;
use super::recorded_bout::recorded_episode;
use crate::gpu::Gpu;
use crate::nn::Policy;
use crate::playback::player::Style;
use crate::train::body_episodes::BodyEpisodes;
use crate::train::playthrough::PlaythroughContext;
use crate::train::task::Task;
use anyhow::Result;

/// Pixels.
const SIZE: [u32; 2] = [320, 180];
/// Length, s, and pictures a second.
const SECONDS: f32 = 5.0;
const RATE: u32 = 10;

/// Films the first evaluation episode of a task under a policy, as a GIF file; `None` if the task has nothing to
/// show.
///
/// # Errors
/// The GPU was lost.
pub fn policy_film(gpu: &Gpu, task: &dyn Task, policy: &Policy) -> Result<Option<Vec<u8>>> {
    if let Some(body) = task.body() {
        return body_film(gpu, task, &body, policy).map(Some);
    }
    let Some(locomotion) = task.locomotion() else {
        return Ok(None);
    };
    let (matcher, task) = (locomotion.matcher.clone(), locomotion.task);
    let context = PlaythroughContext::new(matcher, task, Style::BEST);
    let (policy, camera) = (policy.clone(), Camera::default());
    let mut film = LocomotionFilm::new(gpu, context, policy, 0, camera, SIZE);
    gif(&mut film, SECONDS, RATE, SIZE).map(Some)
}

fn body_film(gpu: &Gpu, task: &dyn Task, body: &BodyEpisodes, policy: &Policy) -> Result<Vec<u8>> {
    let (mut env, driver) = (body.open(0), task.driver(policy));
    let model = env.task().model().clone();
    let (motion, bout) = recorded_episode(&mut env, &*driver, "episode", body.bouts.clone());
    let camera = Camera::default();
    let mut film = BodyFilm::new(gpu, &model, &motion, bout.as_ref(), camera, SIZE);
    gif(&mut film, SECONDS, RATE, SIZE)
}
