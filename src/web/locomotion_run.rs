//! A run of motion matching in a page.

use super::motion_parts::MotionHeader;
use super::played_run::{FrameProgress, PlayedRun, Query, RunState};
use crate::env::locomotion::LocomotionTask;
use crate::matching::MotionMatcher;
use crate::motion::database::Database;
use crate::motion::features::FRAMES_PER_STEP;
use crate::nn::Policy;
use crate::playback::capsule_rig::CapsuleRig;
use crate::playback::player::{Feet, Style};
use crate::train::playthrough::{Due, Playthrough, PlaythroughContext};
use crate::view::camera::{Camera, Ray};
use crate::view::debug_draw;
use crate::view::scene::Scene;
use anyhow::{Context, Result, bail};
use std::sync::Arc;

/// One character that goes to its target.
pub struct LocomotionRun {
    policy: Policy,
    header: MotionHeader,
    context: PlaythroughContext,
    /// Of no motion: what the playthrough holds while parts are added, for which nobody else may hold the motion.
    aside: PlaythroughContext,
    /// `None` until there is motion.
    playthrough: Option<Playthrough>,
    awaits_match: bool,
    parts: usize,
    arrivals: u32,
    frames_shown: u64,
    /// The obstacle being dragged, and the pointer relative to its centre, m.
    grabbed: Option<(usize, [f32; 2])>,
}

impl LocomotionRun {
    /// The run before its first part of motion.
    pub fn new(policy: Policy, task: LocomotionTask, header: MotionHeader) -> LocomotionRun {
        LocomotionRun {
            policy,
            context: context(task, header.empty()),
            aside: context(task, header.empty()),
            header,
            playthrough: None,
            awaits_match: false,
            parts: 0,
            arrivals: 0,
            frames_shown: 0,
            grabbed: None,
        }
    }

    /// Begins the next step as soon as the last frame of one is shown: the search has a thirtieth of a second.
    fn prepare(&mut self) -> Result<()> {
        let Some(playthrough) = &mut self.playthrough else {
            return Ok(());
        };
        if playthrough.played == FRAMES_PER_STEP
            && !self.awaits_match
            && playthrough.due(&self.context) == Due::Query
        {
            playthrough.query(&self.policy)?;
            self.awaits_match = true;
        }
        Ok(())
    }

    fn matched(&mut self) {
        let Some(playthrough) = self.playthrough.as_mut().filter(|_| self.awaits_match) else {
            return;
        };
        playthrough.play_match(&self.context);
        self.arrivals += u32::from(playthrough.has_arrived());
        self.awaits_match = false;
    }
}

fn context(task: LocomotionTask, (database, feet): (Database, Feet)) -> PlaythroughContext {
    PlaythroughContext {
        rig: Arc::new(CapsuleRig::of(&database.skeleton, &database.roles)),
        feet: Arc::new(feet),
        matcher: Arc::new(MotionMatcher {
            database: Arc::new(database),
            index: None,
        }),
        task,
        style: Style::BEST,
    }
}

impl PlayedRun for LocomotionRun {
    fn add_part(&mut self, bytes: &[u8]) -> Result<()> {
        if self.parts == self.header.parts() {
            bail!("there are only {} parts of motion", self.parts);
        }
        if let Some(playthrough) = &mut self.playthrough {
            playthrough.set_context(&self.aside);
        }
        let matcher = Arc::get_mut(&mut self.context.matcher);
        let database = matcher.and_then(|matcher| Arc::get_mut(&mut matcher.database));
        let feet = Arc::get_mut(&mut self.context.feet);
        let (database, feet) = database.zip(feet).context("the motion is in use")?;
        let name = part_name(self.parts);
        self.header.append(database, feet, &name, bytes)?;
        self.parts += 1;
        match &mut self.playthrough {
            Some(playthrough) => playthrough.set_context(&self.context),
            None => self.playthrough = Some(Playthrough::new(&self.context, 0)),
        }
        self.prepare()
    }

    fn is_ready(&self) -> bool {
        self.playthrough.is_some()
    }

    fn advance(&mut self) -> Result<FrameProgress> {
        self.prepare()?;
        if self.awaits_match {
            return Ok(FrameProgress::AwaitsMatch);
        }
        if let Some(playthrough) = &mut self.playthrough {
            playthrough.show_next(&self.context);
            self.frames_shown += 1;
        }
        self.prepare()?;
        Ok(FrameProgress::Shown)
    }

    fn query(&self) -> Option<Query<'_>> {
        let playthrough = self.playthrough.as_ref().filter(|_| self.awaits_match)?;
        Some(Query {
            features: &playthrough.env.queries[0],
            candidates: self.context.database().candidates.len(),
        })
    }

    fn search(&mut self) {
        if let Some(playthrough) = self.playthrough.as_mut().filter(|_| self.awaits_match) {
            playthrough.env.search();
            self.matched();
        }
    }

    fn set_match(&mut self, candidate: u32) {
        let known = self.context.database().candidates.len() as u32;
        if let Some(playthrough) = self.playthrough.as_mut().filter(|_| candidate < known) {
            playthrough.env.matched[0] = candidate;
            self.matched();
        }
    }

    fn search_rows(&self, first: usize) -> Vec<f32> {
        let database = self.context.database();
        let candidates = database.candidates[first.min(database.candidates.len())..].iter();
        let rows = candidates.map(|&frame| database.features[frame as usize]);
        rows.collect::<Vec<_>>().into_flattened()
    }

    fn scene(&self, _: &Camera) -> Scene {
        let playthrough = self.playthrough.as_ref();
        playthrough.map_or_else(Scene::default, |now| debug_draw::scene(now, &self.context))
    }

    fn focus(&self) -> ([f32; 2], f32) {
        let at = self.playthrough.as_ref().map(|now| now.shown.at);
        (at.unwrap_or_default(), 0.0)
    }

    fn camera(&self) -> Camera {
        match self.context.task.obstacles() {
            0 => Camera {
                distance: 7.0,
                ..Camera::default()
            },
            _ => Camera {
                distance: 9.0,
                pitch: 0.6,
                ..Camera::default()
            },
        }
    }

    fn press(&mut self, ray: &Ray) -> bool {
        self.grabbed = ray
            .ground()
            .and_then(|at| self.playthrough.as_ref()?.obstacle_at(at));
        self.grabbed.is_some()
    }

    fn drag(&mut self, ray: &Ray) {
        if let (Some((slot, [x, z])), Some(at), Some(playthrough)) =
            (self.grabbed, ray.ground(), &mut self.playthrough)
        {
            playthrough.move_obstacle(slot, [at[0] - x, at[1] - z]);
        }
    }

    fn release(&mut self) {
        self.grabbed = None;
    }

    fn click(&mut self, ray: &Ray) -> Result<()> {
        if let (Some(at), Some(playthrough)) = (ray.ground(), &mut self.playthrough) {
            playthrough.set_target(at);
        }
        Ok(())
    }

    fn state(&self) -> RunState {
        let motion = [self.context.database().frames(), self.header.frames];
        let Some(now) = &self.playthrough else {
            return RunState {
                motion,
                ..RunState::default()
            };
        };
        let ([x, z], [to_x, to_z]) = (now.shown.at, now.target());
        RunState {
            at: [x, z],
            target: Some([to_x, to_z]),
            distance: Some((to_x - x).hypot(to_z - z)),
            arrivals: self.arrivals,
            height: 0.0,
            episode: now.episode,
            frames_shown: self.frames_shown,
            motion,
            obstacles: now.obstacles().iter().map(|[x, z, ..]| [*x, *z]).collect(),
        }
    }
}

/// Name of a part's file.
pub fn part_name(part: usize) -> String {
    format!("motion-{part:03}.footwork")
}
