//! The page of a run: time, camera, pointer and picture, whatever is played.

use super::body_run::BodyRun;
use super::locomotion_run::LocomotionRun;
use super::played_run::{FrameProgress, PlayedRun, Query, RunState};
use super::run_file::{Played, RunFile};
use crate::motion::RATE;
use crate::view::camera::{Camera, FOLLOW, Ray};
use crate::view::scene::{Capsule, Cuboid, Scene};
use crate::view::sunlight::PassView;
use anyhow::Result;
use glam::Vec2;

/// Seconds of a frame.
const FRAME_S: f32 = 1.0 / RATE;
/// More than so many seconds between two pictures are let go: the page was not shown.
const MOST_S: f32 = 0.1;
/// Farthest that the pointer moves in a click, parts of half the picture's height.
const CLICK: f32 = 0.02;
/// Angle that the camera turns by when the pointer crosses half the picture's height, rad.
const TURN: f32 = 1.6;

/// A run in a page.
pub struct Page {
    /// Name of the run's task.
    pub task: String,
    run: Box<dyn PlayedRun>,
    /// Where the picture is seen from.
    pub camera: Camera,
    /// Width of the picture over its height.
    aspect: f32,
    /// Time since the frame shown, s.
    since: f32,
    /// The frame shown, and the one before it.
    scenes: [Scene; 2],
    pointer: Option<Pointer>,
}

/// A pointer that is down.
struct Pointer {
    at: Vec2,
    down_at: Vec2,
    /// It has hold of something.
    holds: bool,
    /// It has moved too far for a click.
    moved: bool,
}

/// What is drawn now.
pub struct Picture {
    /// The sun's view, then the camera's.
    pub views: [PassView; 2],
    /// Between the frame shown and the one before it.
    pub scene: Scene,
}

impl Page {
    /// The page of a run's file.
    ///
    /// # Errors
    /// It is damaged, or of another version.
    pub fn open(run: &[u8]) -> Result<Page> {
        let RunFile {
            task,
            policy,
            played,
            ..
        } = RunFile::from_bytes(run)?;
        let run: Box<dyn PlayedRun> = match played {
            Played::Locomotion { task, motion } => {
                Box::new(LocomotionRun::new(policy, task, *motion))
            }
            Played::Body { config, recordings } => {
                Box::new(BodyRun::new(&policy, &config, recordings)?)
            }
        };
        Ok(Page {
            task,
            camera: run.camera(),
            run,
            aspect: 1.0,
            since: FRAME_S,
            scenes: [Scene::default(), Scene::default()],
            pointer: None,
        })
    }

    /// Adds the next part of the motion.
    ///
    /// # Errors
    /// It is damaged, or there is no other.
    pub fn add_part(&mut self, bytes: &[u8]) -> Result<()> {
        self.run.add_part(bytes)
    }

    /// Goes on by so many seconds, unless the next frame waits for a match: see [`Page::query`].
    ///
    /// # Errors
    /// The environment's.
    pub fn advance(&mut self, seconds: f32) -> Result<()> {
        if !self.run.is_ready() {
            return Ok(());
        }
        self.since += seconds.min(MOST_S);
        self.run.look(&self.camera);
        while self.since >= FRAME_S {
            if self.run.advance()? == FrameProgress::AwaitsMatch {
                // What is late is shown at once, and no time made up for.
                self.since = FRAME_S;
                break;
            }
            self.since -= FRAME_S;
            self.scenes.swap(0, 1);
            self.scenes[0] = self.run.scene(&self.camera);
        }
        let ([x, z], side) = self.run.focus();
        let fraction = 1.0 - (1.0 - FOLLOW).powf(seconds.min(MOST_S) / FRAME_S);
        self.camera.frame([x, z], side, self.aspect, fraction);
        Ok(())
    }

    /// The query that the next frame waits for.
    pub fn query(&self) -> Option<Query<'_>> {
        self.run.query()
    }

    /// Answers the query here and now.
    pub fn search(&mut self) {
        self.run.search();
    }

    /// Answers the query by what a search elsewhere has found.
    pub fn set_match(&mut self, candidate: u32) {
        self.run.set_match(candidate);
    }

    /// Rows of candidates from a number on, as `shaders/search/search_one.wgsl` reads them.
    pub fn search_rows(&self, first: usize) -> Vec<f32> {
        self.run.search_rows(first)
    }

    /// What is drawn now, in a picture `aspect` times as wide as high.
    pub fn picture(&mut self, aspect: f32) -> Picture {
        self.aspect = aspect;
        Picture {
            views: PassView::of(&self.camera, aspect),
            scene: between(&self.scenes, (self.since / FRAME_S).min(1.0)),
        }
    }

    /// The pointer goes down at a point of the picture, from (-1, -1) at the lower left to (1, 1).
    pub fn press(&mut self, at: [f32; 2]) {
        let at = Vec2::from_array(at);
        let ray = self.ray(at);
        self.pointer = Some(Pointer {
            at,
            down_at: at,
            holds: self.run.press(&ray),
            moved: false,
        });
    }

    /// The pointer moves, while it is down: what it holds is dragged, or the camera turned.
    pub fn drag(&mut self, at: [f32; 2]) {
        let at = Vec2::from_array(at);
        let (ray, aspect) = (self.ray(at), self.aspect);
        let Some(pointer) = &mut self.pointer else {
            return;
        };
        let far = (at - pointer.down_at) * Vec2::new(aspect, 1.0);
        pointer.moved |= far.length() > CLICK;
        let moved = (at - pointer.at) * Vec2::new(aspect, 1.0);
        pointer.at = at;
        if !pointer.moved {
            return;
        }
        match pointer.holds {
            true => self.run.drag(&ray),
            false => self.camera.orbit(-TURN * moved.x, -TURN * moved.y),
        }
        self.scenes[0] = self.run.scene(&self.camera);
    }

    /// The pointer goes up: where it has not moved, that was a click.
    ///
    /// # Errors
    /// The environment's.
    pub fn release(&mut self) -> Result<()> {
        let Some(pointer) = self.pointer.take() else {
            return Ok(());
        };
        self.run.release();
        if !pointer.moved {
            let ray = self.ray(pointer.at);
            self.run.click(&ray)?;
            self.scenes[0] = self.run.scene(&self.camera);
        }
        Ok(())
    }

    /// What there is to tell.
    pub fn state(&self) -> RunState {
        self.run.state()
    }

    fn ray(&self, at: Vec2) -> Ray {
        self.camera.ray(at, self.aspect)
    }
}

/// The scene a fraction of the way from the one before to the one shown. Where other things are in it, there is no way
/// in between.
fn between([shown, before]: &[Scene; 2], fraction: f32) -> Scene {
    let mix = |a: f32, b: f32| a + fraction * (b - a);
    let mix3 = |a: [f32; 3], b: [f32; 3]| std::array::from_fn(|i| mix(a[i], b[i]));
    let mut scene = shown.clone();
    if before.capsules.len() == shown.capsules.len() {
        let pairs = before.capsules.iter().zip(&mut scene.capsules);
        pairs.for_each(|(before, now)| {
            *now = Capsule {
                a: mix3(before.a, now.a),
                b: mix3(before.b, now.b),
                ..*now
            }
        });
    }
    if before.cuboids.len() == shown.cuboids.len() {
        let pairs = before.cuboids.iter().zip(&mut scene.cuboids);
        pairs.for_each(|(before, now)| {
            let [from, to] = [before.rotation, now.rotation].map(glam::Quat::from_array);
            *now = Cuboid {
                centre: mix3(before.centre, now.centre),
                rotation: from.lerp(to, fraction).to_array(),
                ..*now
            }
        });
    }
    scene
}
