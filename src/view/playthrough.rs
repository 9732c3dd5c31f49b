//! One character under a controller, frame by frame, for somebody to watch.

use super::capsule_rig::Body;
use crate::kernels::locomotion::locomotion_layout::{boxes, state_f32, state_u32};
use crate::kernels::termination;
use crate::motion::database::Database;
use crate::motion::features::{TRAJECTORY_OFFSETS, FRAMES_PER_STEP, POSE_DIM, TRAJECTORY_DIM};
use crate::motion::character_frame::to_world;
use crate::playback::player::{Feet, Player, Style};
use crate::playback::{Pose, Shown};
use crate::train::controller::Controller;
use crate::train::evaluate::{advance, episodes, send_elsewhere};
use crate::train::rendered_frames::standing;
use crate::env::locomotion::cpu::CpuLocomotion;
use crate::env::locomotion::{LEVELS, Task};
use anyhow::Result;
use std::sync::Arc;

/// What stays the same while a rollout is watched.
#[derive(Clone)]
pub struct Stage {
    pub database: Arc<Database>,
    pub feet: Arc<Feet>,
    pub body: Arc<Body>,
    pub task: Task,
    pub style: Style,
}

impl Stage {
    pub fn new(database: Arc<Database>, task: Task, style: Style) -> Stage {
        Stage {
            feet: Arc::new(Feet::of(&database)),
            body: Arc::new(Body::of(&database.skeleton, &database.roles)),
            database,
            task,
            style,
        }
    }
}

/// What a step asked for and what it got.
#[derive(Clone, Debug)]
pub struct Step {
    /// Where the character stood.
    pub from: Shown,
    /// The trajectory asked for, in the world: x, z (m), heading x, heading z.
    pub asked: [[f32; 4]; TRAJECTORY_OFFSETS.len()],
    /// The database frame found.
    pub matched: usize,
    /// One of the [`end`]s.
    pub termination: u32,
    /// `[boxes::FIELDS][count]` before the step, m.
    boxes: Vec<f32>,
    /// The obstacle maps it was decided by.
    maps: Vec<u32>,
}

/// The character at one frame, and all that decides the next ones.
#[derive(Clone)]
pub struct Rollout {
    /// One environment. It is ahead of what is shown by up to a step.
    pub world: CpuLocomotion,
    /// Of the evaluation, the same for every policy.
    pub episode: usize,
    /// `None` until the first step.
    pub step: Option<Step>,
    /// Frames of the step that are shown, of [`FRAMES_PER_STEP`].
    pub played: usize,
    pub shown: Shown,
    pub pose: Pose,
    player: Player,
}

impl Rollout {
    /// The start of an evaluation episode on the hardest level.
    pub fn new(stage: &Stage, episode: usize) -> Rollout {
        let mut world = episodes(&stage.database, stage.task, LEVELS - 1, episode + 1);
        world.keep(&[episode]);
        // Whoever watches says when it is over.
        world.state_u32[state_u32::EPISODE_LIMIT] = u32::MAX;
        let shown = standing(&world, 0);
        let (database, feet) = (stage.database.clone(), stage.feet.clone());
        Rollout {
            world,
            episode,
            step: None,
            played: FRAMES_PER_STEP,
            shown,
            pose: shown.pose(&stage.database),
            player: Player::new(database, feet, stage.style, shown),
        }
    }

    /// Goes on by a frame: a thirtieth of a second. A character that has reached its target is sent
    /// to another; one that has run into an obstacle begins the next episode.
    ///
    /// # Errors
    /// The controller's.
    pub fn advance(&mut self, stage: &Stage, controller: &dyn Controller) -> Result<()> {
        if self.played == FRAMES_PER_STEP {
            match self.step.as_ref().map_or(termination::RUNNING, |step| step.termination) {
                termination::FAILED => {
                    *self = Rollout::new(stage, self.episode + 1);
                    return Ok(());
                }
                termination::SUCCESS => send_elsewhere(&mut self.world, 0),
                _ => {}
            }
            self.decide(stage, controller)?;
        }
        let Some(step) = &self.step else {
            return Ok(());
        };
        self.played += 1;
        // A match changes the frame alone: the character stays where it is.
        let from = Shown {
            frame: step.matched,
            ..step.from
        };
        self.shown = from.on(&stage.database, self.played as isize);
        self.pose = self.player.next(self.shown);
        Ok(())
    }

    fn decide(&mut self, stage: &Stage, controller: &dyn Controller) -> Result<()> {
        let (from, boxes) = (standing(&self.world, 0), self.world.boxes.clone());
        let maps = self.world.maps.clone();
        advance(&mut self.world, controller)?;
        self.step = Some(Step {
            asked: asked(&stage.database, &self.world, from),
            matched: stage.database.candidates[self.world.matched[0] as usize] as usize,
            termination: self.world.termination[0],
            from,
            boxes,
            maps,
        });
        self.played = 0;
        Ok(())
    }

    /// The obstacle maps that the running step was decided by.
    pub fn maps(&self) -> &[u32] {
        self.step
            .as_ref()
            .map_or(&self.world.maps, |step| &step.maps)
    }

    /// m, on the ground.
    pub fn target(&self) -> [f32; 2] {
        [state_f32::TARGET_X, state_f32::TARGET_Z].map(|field| self.world.field(field, 0))
    }

    /// m, on the ground.
    pub fn set_target(&mut self, at: [f32; 2]) {
        for (field, value) in [state_f32::TARGET_X, state_f32::TARGET_Z].into_iter().zip(at) {
            self.world.state_f32[field] = value;
        }
        // An arrival on the way would draw another.
        if let Some(step) = &mut self.step
            && step.termination == termination::SUCCESS
        {
            step.termination = termination::RUNNING;
        }
    }

    /// Puts an obstacle's centre elsewhere, m.
    pub fn move_obstacle(&mut self, slot: usize, at: [f32; 2]) {
        let count = stage_count(&self.world);
        for (field, value) in [boxes::X, boxes::Z].into_iter().zip(at) {
            self.world.boxes[field * count + slot] = value;
            if let Some(step) = &mut self.step {
                step.boxes[field * count + slot] = value;
            }
        }
        self.world.look_again();
    }

    /// Centre and half sides (m) of every obstacle at the frame shown.
    pub fn obstacles(&self) -> Vec<[f32; boxes::FIELDS]> {
        let count = stage_count(&self.world);
        let share = self.played as f32 / FRAMES_PER_STEP as f32;
        let value = |field: usize, slot: usize| {
            let now = self.world.boxes[field * count + slot];
            let before = self.step.as_ref();
            let before = before.map_or(now, |step| step.boxes[field * count + slot]);
            before + share * (now - before)
        };
        (0..count)
            .map(|slot| std::array::from_fn(|field| value(field, slot)))
            .collect()
    }
}

fn stage_count(world: &CpuLocomotion) -> usize {
    world.rules.task.obstacles()
}

/// The trajectory that the last query asked for, in the world of a character that stood at `from`.
fn asked(database: &Database, world: &CpuLocomotion, from: Shown) -> [[f32; 4]; TRAJECTORY_OFFSETS.len()] {
    let normal = &database.normalisation;
    let query = &world.queries[0][POSE_DIM..][..TRAJECTORY_DIM];
    let value = |i: usize| query[i] / normal.scale[POSE_DIM + i] + normal.mean[POSE_DIM + i];
    std::array::from_fn(|k| {
        let [x, z, hx, hz] = std::array::from_fn(|i| value(4 * k + i));
        let (moved, turned) = (
            to_world([x, z], from.heading),
            to_world([hx, hz], from.heading),
        );
        let length = turned[0].hypot(turned[1]).max(1e-6);
        [
            from.at[0] + moved[0],
            from.at[1] + moved[1],
            turned[0] / length,
            turned[1] / length,
        ]
    })
}
