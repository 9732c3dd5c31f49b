//! What a page shows, whatever is played.

use crate::view::camera::{Camera, Ray};
use crate::view::scene::Scene;
use anyhow::Result;
use serde::Serialize;

/// How far the next frame has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameProgress {
    /// It is shown.
    Shown,
    /// It waits for the search.
    AwaitsMatch,
}

/// A query that waits for the candidate nearest to it.
pub struct Query<'a> {
    /// Normalised features.
    pub features: &'a [f32],
    /// Candidates that are to be compared.
    pub candidates: usize,
}

/// What there is to tell of a run that is played.
#[derive(Clone, Debug, Default, Serialize)]
pub struct RunState {
    /// On the ground, m.
    pub at: [f32; 2],
    /// On the ground, m, where there is one.
    pub target: Option<[f32; 2]>,
    /// Distance to the target, m.
    pub distance: Option<f32>,
    /// Targets reached so far.
    pub arrivals: u32,
    /// Number of the episode.
    pub episode: usize,
    /// Frames shown so far.
    pub frames_shown: u64,
    /// Frames of motion that are there, and of all.
    pub motion: [usize; 2],
    /// Height of the highest part of a simulated body, m.
    pub height: f32,
    /// Centres of the obstacles, m.
    pub obstacles: Vec<[f32; 2]>,
}

/// A run that is played in a page, a thirtieth of a second a frame.
pub trait PlayedRun {
    /// Adds the next part of the motion.
    ///
    /// # Errors
    /// It is damaged, or there is no other.
    fn add_part(&mut self, bytes: &[u8]) -> Result<()>;

    /// Whether there is enough to begin.
    fn is_ready(&self) -> bool;

    /// Shows the next frame, if all is there that it needs.
    ///
    /// # Errors
    /// The environment's.
    fn advance(&mut self) -> Result<FrameProgress>;

    /// The query of [`FrameProgress::AwaitsMatch`].
    fn query(&self) -> Option<Query<'_>> {
        None
    }

    /// Finds the candidate here and now.
    fn search(&mut self) {}

    /// Takes what a search elsewhere has found.
    fn set_match(&mut self, _candidate: u32) {}

    /// Rows of candidates from a number on, as `shaders/search/search_one.wgsl` reads them.
    fn search_rows(&self, _first: usize) -> Vec<f32> {
        Vec::new()
    }

    /// What to draw.
    fn scene(&self, camera: &Camera) -> Scene;

    /// The point on the ground to look at, m, and how far from it who belongs into the picture stands, m.
    fn focus(&self) -> ([f32; 2], f32);

    /// Takes the camera of the picture that the pointer is on.
    fn look(&mut self, _camera: &Camera) {}

    /// A camera to begin with.
    fn camera(&self) -> Camera {
        Camera::default()
    }

    /// The pointer goes down: whether it takes hold of something.
    fn press(&mut self, ray: &Ray) -> bool;

    /// The pointer moves while it holds something.
    fn drag(&mut self, ray: &Ray);

    /// The pointer lets go.
    fn release(&mut self);

    /// The pointer went down and up in one place, and held nothing.
    ///
    /// # Errors
    /// The environment's.
    fn click(&mut self, ray: &Ray) -> Result<()>;

    /// What there is to tell.
    fn state(&self) -> RunState;
}
