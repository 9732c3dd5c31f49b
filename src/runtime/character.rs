//! One character: five times a second its policy decides, thirty times a second it shows a pose.

use super::character_motion::CharacterMotion;
use super::character_policy::CharacterPolicy;
use crate::env::locomotion::kernel_params::KernelParams;
use crate::env::locomotion::{EnvConfig, LEVELS, LocomotionTask};
use crate::kernels::locomotion::locomotion_layout::{MAP_WORDS, state_f32, state_u32};
use crate::kernels::locomotion::rasterize_maps::Surroundings;
use crate::kernels::locomotion::{advance_and_reward, build_query, observe};
use crate::matching::SearchScratch;
use crate::motion::features::{FRAMES_PER_STEP, ROW_STRIDE, TRAJECTORY_OFFSETS};
use crate::motion::skeleton::JointTransforms;
use crate::nn::PolicyScratch;
use crate::playback::player::{Player, Style};
use crate::playback::{CharacterPose, PlacedFrame};

/// An obstacle on the ground: a box along the axes of the world.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MovingObstacle {
    /// Its centre, `[x, z]`, m.
    pub centre: [f32; 2],
    /// Half its sides, m.
    pub half: [f32; 2],
    /// Its velocity, m/s.
    pub velocity: [f32; 2],
}

/// Where a character is, and what has been decided for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CharacterState {
    /// The frame shown, and where.
    pub shown: PlacedFrame,
    /// The frame that the last search found; the one begun with before the first.
    pub matched: usize,
    /// The target on the ground, m.
    pub target: Option<[f32; 2]>,
    /// The trajectory that the policy last requested, in the world: x, z (m), heading x, heading z.
    pub requested: [[f32; 4]; TRAJECTORY_OFFSETS.len()],
}

/// Memory that all characters of a batch use, one after another.
#[derive(Default)]
pub struct DecisionScratch {
    observation: Vec<f32>,
    policy: PolicyScratch,
    search: SearchScratch,
    /// Earlier places of the obstacles.
    past: Vec<f32>,
}

/// An environment of one, and the player that shows it.
pub struct Character {
    params: KernelParams,
    state_f32: [f32; state_f32::FIELDS],
    state_u32: [u32; state_u32::FIELDS],
    /// `[boxes::FIELDS][count]`
    boxes: Vec<f32>,
    /// `[VELOCITY_DIM][count]`
    velocity: Vec<f32>,
    maps: [u32; MAP_WORDS],
    query: [f32; ROW_STRIDE],
    has_target: bool,
    /// The frame that the present step began with, how many of the following ones are played, and how many are to be.
    from: PlacedFrame,
    played: usize,
    frames: usize,
    requested: [[f32; 4]; TRAJECTORY_OFFSETS.len()],
    shown: PlacedFrame,
    player: Player,
}

impl Character {
    /// A character that stands at the origin and looks along z. It plays `wait` frames before its first decision.
    pub fn new(motion: &CharacterMotion, policy: &CharacterPolicy, wait: usize) -> Self {
        let begun = PlacedFrame {
            frame: motion.rest,
            at: [0.0; 2],
            heading: [0.0, 1.0],
        };
        let config = EnvConfig {
            task: with_obstacles(policy.task, 0),
            envs: 1,
            seed: 0,
            level: LEVELS - 1,
        };
        let candidates = motion.database().candidates.len();
        let mut character = Character {
            params: KernelParams::new(&config, 0, candidates),
            state_f32: [0.0; state_f32::FIELDS],
            state_u32: [0; state_u32::FIELDS],
            boxes: Vec::new(),
            velocity: Vec::new(),
            maps: [0; MAP_WORDS],
            query: [0.0; ROW_STRIDE],
            has_target: false,
            from: begun,
            played: 0,
            frames: 0,
            requested: [[0.0; 4]; TRAJECTORY_OFFSETS.len()],
            shown: begun,
            player: player(motion, begun),
        };
        character.place(motion, begun.at, begun.heading, wait);
        character
    }

    /// Puts the character elsewhere, standing.
    pub fn place(
        &mut self,
        motion: &CharacterMotion,
        at: [f32; 2],
        heading: [f32; 2],
        wait: usize,
    ) {
        let frame = motion.rest;
        let begun = PlacedFrame { frame, at, heading };
        (self.from, self.shown) = (begun, begun);
        (self.played, self.frames) = (0, wait);
        self.player = player(motion, begun);
        self.requested = begun.path(motion.database());
        self.set_standing(begun.on(motion.database(), wait as isize));
        self.state_u32[state_u32::EPISODE_STEP] = 0;
        self.state_u32[state_u32::EPISODE_LIMIT] = u32::MAX;
    }

    fn set_standing(&mut self, at: PlacedFrame) {
        self.state_f32[state_f32::X] = at.at[0];
        self.state_f32[state_f32::Z] = at.at[1];
        self.state_f32[state_f32::HEADING_X] = at.heading[0];
        self.state_f32[state_f32::HEADING_Z] = at.heading[1];
        self.state_u32[state_u32::FRAME] = at.frame as u32;
    }

    /// Where the present step ends.
    fn standing(&self) -> PlacedFrame {
        let state = |field: usize| self.state_f32[field];
        PlacedFrame {
            frame: self.state_u32[state_u32::FRAME] as usize,
            at: [state_f32::X, state_f32::Z].map(state),
            heading: [state_f32::HEADING_X, state_f32::HEADING_Z].map(state),
        }
    }

    pub fn set_target(&mut self, at: [f32; 2]) {
        self.state_f32[state_f32::TARGET_X] = at[0];
        self.state_f32[state_f32::TARGET_Z] = at[1];
        self.has_target = true;
    }

    pub fn has_target(&self) -> bool {
        self.has_target
    }

    pub fn set_obstacles(&mut self, obstacles: &[MovingObstacle]) {
        self.params.task = with_obstacles(self.params.task, obstacles.len());
        let all = |field: fn(&MovingObstacle) -> f32| obstacles.iter().map(field);
        self.boxes.clear();
        self.boxes.extend(all(|obstacle| obstacle.centre[0]));
        self.boxes.extend(all(|obstacle| obstacle.centre[1]));
        self.boxes.extend(all(|obstacle| obstacle.half[0]));
        self.boxes.extend(all(|obstacle| obstacle.half[1]));
        self.velocity.clear();
        self.velocity.extend(all(|obstacle| obstacle.velocity[0]));
        self.velocity.extend(all(|obstacle| obstacle.velocity[1]));
    }

    /// Goes on by a frame, a thirtieth of a second.
    pub fn step(
        &mut self,
        motion: &CharacterMotion,
        policy: &CharacterPolicy,
        scratch: &mut DecisionScratch,
    ) {
        if self.played == self.frames {
            self.decide(motion, policy, scratch);
        }
        self.played += 1;
        self.shown = self.from.on(motion.database(), self.played as isize);
        self.player.next(self.shown);
    }

    fn decide(
        &mut self,
        motion: &CharacterMotion,
        policy: &CharacterPolicy,
        scratch: &mut DecisionScratch,
    ) {
        let (database, from) = (motion.database(), self.standing());
        if self.params.task.has_maps() {
            let just_reset = self.state_u32[state_u32::EPISODE_STEP] == 0;
            let seen = Surroundings {
                boxes: &self.boxes,
                velocity: &self.velocity,
                at: from.at,
                heading: from.heading,
            };
            let params = self.params.rasterize_maps(just_reset);
            seen.draw(&params, just_reset, &mut scratch.past, &mut self.maps);
        }
        scratch
            .observation
            .resize(self.params.observation_dim(), 0.0);
        observe::twin(
            &database.features,
            &self.state_f32,
            &self.state_u32,
            &[0],
            &self.maps,
            &mut scratch.observation,
            &self.params.observe(0),
        );
        let action = policy
            .policy
            .mean_one(&scratch.observation, &mut scratch.policy);
        build_query::twin(
            &database.features,
            &self.state_u32,
            action,
            std::slice::from_mut(&mut self.query),
            &self.params.build_query(0),
        );
        let frame = self.state_u32[state_u32::FRAME];
        let found = motion
            .matcher
            .nearest_with(frame, &self.query, &mut scratch.search);
        self.requested = from.requested(database, &self.query);
        advance_and_reward::twin(
            &database.candidates,
            &[found.index],
            &database.motion,
            &mut self.state_f32,
            &mut self.state_u32,
            &mut [0.0],
            &mut [0],
            &self.params.advance_and_reward(),
        );
        // A match changes the frame alone: the character stays where it is.
        self.from = PlacedFrame {
            frame: database.candidates[found.index as usize] as usize,
            ..from
        };
        (self.played, self.frames) = (0, FRAMES_PER_STEP);
    }

    pub fn state(&self) -> CharacterState {
        let target = [state_f32::TARGET_X, state_f32::TARGET_Z];
        let target = target.map(|field| self.state_f32[field]);
        CharacterState {
            shown: self.shown,
            matched: self.from.frame,
            target: self.has_target.then_some(target),
            requested: self.requested,
        }
    }

    pub fn pose(&self) -> &CharacterPose {
        self.player.pose()
    }

    pub fn world(&self) -> &JointTransforms {
        self.player.world()
    }
}

fn player(motion: &CharacterMotion, shown: PlacedFrame) -> Player {
    let (database, feet) = (motion.database().clone(), motion.feet.clone());
    Player::new(database, feet, Style::BEST, shown)
}

/// The task with another number of obstacles.
fn with_obstacles(task: LocomotionTask, count: usize) -> LocomotionTask {
    match task {
        LocomotionTask::Plane(_) => task,
        LocomotionTask::Obstacles(mut obstacles) => {
            obstacles.count = count as u32;
            LocomotionTask::Obstacles(obstacles)
        }
    }
}
