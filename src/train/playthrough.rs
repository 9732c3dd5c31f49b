//! One character under a controller, frame by frame, for somebody to watch.

use super::controller::Controller;
use super::evaluate::{episodes, send_elsewhere};
use super::rendered_frames::standing;
use crate::env::locomotion::cpu::CpuLocomotion;
use crate::env::locomotion::{LEVELS, LocomotionTask};
use crate::env::termination;
use crate::kernels::locomotion::locomotion_layout::{boxes, state_f32, state_u32};
use crate::matching::MotionMatcher;
use crate::motion::database::Database;
use crate::motion::features::{FRAMES_PER_STEP, TRAJECTORY_OFFSETS};
use crate::playback::capsule_rig::CapsuleRig;
use crate::playback::player::{Feet, Player, Style};
use crate::playback::{CharacterPose, PlacedFrame};
use anyhow::Result;
use std::sync::Arc;

/// What all playthroughs of a task share.
#[derive(Clone)]
pub struct PlaythroughContext {
    /// The motion and its index.
    pub matcher: Arc<MotionMatcher>,
    /// Legs and contacts of the motion.
    pub feet: Arc<Feet>,
    /// The capsules that are drawn.
    pub rig: Arc<CapsuleRig>,
    /// The task that is played.
    pub task: LocomotionTask,
    /// How poses are joined.
    pub style: Style,
}

impl PlaythroughContext {
    /// The context of a task over a database. `style` says how its poses are joined.
    pub fn new(
        matcher: Arc<MotionMatcher>,
        task: LocomotionTask,
        style: Style,
    ) -> PlaythroughContext {
        let database = &matcher.database;
        PlaythroughContext {
            feet: Arc::new(Feet::of(database)),
            rig: Arc::new(CapsuleRig::of(&database.skeleton, &database.roles)),
            matcher,
            task,
            style,
        }
    }

    /// The motion that is played.
    pub fn database(&self) -> &Arc<Database> {
        &self.matcher.database
    }
}

/// The request and the result of a step.
#[derive(Clone, Debug)]
pub struct Step {
    /// The character before it.
    pub from: PlacedFrame,
    /// The requested trajectory, in the world: x, z (m), heading x, heading z.
    pub requested: [[f32; 4]; TRAJECTORY_OFFSETS.len()],
    /// The database frame found.
    pub matched: usize,
    /// How it ended, one of [`crate::env::termination`].
    pub termination: u32,
    /// `[boxes::FIELDS][count]` before the step, m.
    boxes: Vec<f32>,
    /// The obstacle maps that were observed before it.
    maps: Vec<u32>,
}

/// What a step was begun with.
#[derive(Clone, Debug)]
struct Before {
    from: PlacedFrame,
    boxes: Vec<f32>,
    maps: Vec<u32>,
}

/// What the next frame waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Due {
    /// For a query and its match: a step is over.
    Query,
    /// Only to be shown.
    Frame,
    /// It is shown already: an episode has begun.
    Nothing,
}

/// The character at one frame, and all that decides the next ones.
#[derive(Clone)]
pub struct Playthrough {
    /// One environment. It is ahead of what is shown by up to a step.
    pub env: CpuLocomotion,
    /// Number of the evaluation episode, the same for every policy.
    pub episode: usize,
    /// `None` until the first step.
    pub step: Option<Step>,
    /// Frames of the step that are shown, of [`FRAMES_PER_STEP`].
    pub played: usize,
    /// The shown frame and its position.
    pub shown: PlacedFrame,
    /// The shown pose.
    pub pose: CharacterPose,
    /// While a query waits for its match.
    before: Option<Before>,
    player: Player,
}

impl Playthrough {
    /// The start of an evaluation episode on the hardest level.
    pub fn new(context: &PlaythroughContext, episode: usize) -> Playthrough {
        let mut env = episodes(&context.matcher, context.task, LEVELS - 1, episode + 1);
        env.retain(&[episode]);
        // Whoever watches says when it is over.
        env.state_u32[state_u32::EPISODE_LIMIT] = u32::MAX;
        let shown = standing(&env, 0);
        let (database, feet) = (context.database().clone(), context.feet.clone());
        Playthrough {
            env,
            episode,
            step: None,
            played: FRAMES_PER_STEP,
            shown,
            pose: shown.pose(context.database()),
            before: None,
            player: Player::new(database, feet, context.style, shown),
        }
    }

    /// Goes on by a frame: a thirtieth of a second. A character that has reached its target is sent
    /// to another; one that has run into an obstacle begins the next episode.
    ///
    /// # Errors
    /// The controller's.
    pub fn advance(
        &mut self,
        context: &PlaythroughContext,
        controller: &dyn Controller,
    ) -> Result<()> {
        match self.due(context) {
            Due::Query => {
                self.query(controller)?;
                self.env.search();
                self.play_match(context);
                self.show_next(context);
            }
            Due::Frame => self.show_next(context),
            Due::Nothing => {}
        }
        Ok(())
    }

    /// What the next frame waits for. What has ended is begun anew: see [`Playthrough::advance`].
    pub fn due(&mut self, context: &PlaythroughContext) -> Due {
        if self.played < FRAMES_PER_STEP {
            return Due::Frame;
        }
        let ended = self.step.as_mut().map(|step| &mut step.termination);
        match ended {
            Some(&mut termination::FAILED) => {
                *self = Playthrough::new(context, self.episode + 1);
                return Due::Nothing;
            }
            Some(ended @ &mut termination::SUCCESS) => {
                *ended = termination::RUNNING;
                send_elsewhere(&mut self.env, 0);
            }
            _ => {}
        }
        Due::Query
    }

    /// Begins a step: lets the controller say what to search for, [`CpuLocomotion::queries`].
    ///
    /// # Errors
    /// The controller's.
    pub fn query(&mut self, controller: &dyn Controller) -> Result<()> {
        self.before = Some(Before {
            from: standing(&self.env, 0),
            boxes: self.env.boxes.clone(),
            maps: self.env.maps.clone(),
        });
        let observation = self.env.observation();
        let action = controller.act(&observation, self.env.params.observation_dim())?;
        self.env.build_queries(&action);
        Ok(())
    }

    /// Goes on with a step by the frame that the search has found, [`CpuLocomotion::matched`].
    pub fn play_match(&mut self, context: &PlaythroughContext) {
        let Some(Before { from, boxes, maps }) = self.before.take() else {
            return;
        };
        self.env.play_matches();
        self.step = Some(Step {
            requested: from.requested(context.database(), &self.env.queries[0]),
            matched: context.database().candidates[self.env.matched[0] as usize] as usize,
            termination: self.env.termination[0],
            from,
            boxes,
            maps,
        });
        self.played = 0;
    }

    /// Shows the next frame of the running step.
    pub fn show_next(&mut self, context: &PlaythroughContext) {
        let Some(step) = &self.step else {
            return;
        };
        self.played += 1;
        // A match changes the frame alone: the character stays where it is.
        let from = PlacedFrame {
            frame: step.matched,
            ..step.from
        };
        self.shown = from.on(context.database(), self.played as isize);
        self.pose.clone_from(self.player.next(self.shown));
    }

    /// Goes on with the same motion in another place: the context's, which has all frames of the present one.
    pub fn set_context(&mut self, context: &PlaythroughContext) {
        self.env.set_matcher(&context.matcher);
        self.player.set_database(context.database(), &context.feet);
    }

    /// The obstacle maps that were observed before the running step.
    pub fn maps(&self) -> &[u32] {
        self.step.as_ref().map_or(&self.env.maps, |step| &step.maps)
    }

    /// The target on the ground, m.
    pub fn target(&self) -> [f32; 2] {
        [state_f32::TARGET_X, state_f32::TARGET_Z].map(|field| self.env.field(field, 0))
    }

    /// Whether the running step ends at the target.
    pub fn has_arrived(&self) -> bool {
        let step = self.step.as_ref();
        step.is_some_and(|step| step.termination == termination::SUCCESS)
    }

    /// Puts the target elsewhere on the ground, m.
    pub fn set_target(&mut self, at: [f32; 2]) {
        self.env.set_target(0, at);
        // An arrival on the way would draw another.
        if let Some(step) = &mut self.step
            && step.termination == termination::SUCCESS
        {
            step.termination = termination::RUNNING;
        }
    }

    /// Puts an obstacle's centre elsewhere, m.
    pub fn move_obstacle(&mut self, slot: usize, at: [f32; 2]) {
        let count = obstacle_count(&self.env);
        for (field, value) in [boxes::X, boxes::Z].into_iter().zip(at) {
            self.env.boxes[field * count + slot] = value;
            if let Some(step) = &mut self.step {
                step.boxes[field * count + slot] = value;
            }
        }
        self.env.refresh_maps();
    }

    /// Centre and half sides (m) of every obstacle at the frame shown.
    pub fn obstacles(&self) -> Vec<[f32; boxes::FIELDS]> {
        let count = obstacle_count(&self.env);
        let fraction = self.played as f32 / FRAMES_PER_STEP as f32;
        let value = |field: usize, slot: usize| {
            let now = self.env.boxes[field * count + slot];
            let before = self.step.as_ref();
            let before = before.map_or(now, |step| step.boxes[field * count + slot]);
            before + fraction * (now - before)
        };
        (0..count)
            .map(|slot| std::array::from_fn(|field| value(field, slot)))
            .collect()
    }

    /// The obstacle at a point, and the point relative to its centre.
    pub fn obstacle_at(&self, at: [f32; 2]) -> Option<(usize, [f32; 2])> {
        let obstacles = self.obstacles();
        let mut on = obstacles
            .iter()
            .enumerate()
            .filter(|(_, [x, z, half_x, half_z])| {
                (at[0] - x).abs() <= *half_x && (at[1] - z).abs() <= *half_z
            });
        on.next()
            .map(|(slot, [x, z, ..])| (slot, [at[0] - x, at[1] - z]))
    }
}

fn obstacle_count(env: &CpuLocomotion) -> usize {
    env.params.task.obstacles()
}
