//! What is asked of the character.

use crate::env::curriculum::Curriculum;
use crate::env::termination;
use serde::{Deserialize, Serialize};

/// A task with its choices.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LocomotionTask {
    Plane(Plane),
    Obstacles(Obstacles),
}

/// Reach a target on an empty plane (paper, section 3; equation 3).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plane {
    /// Targets are drawn uniformly from a square of twice this side around the start, m.
    pub half_side: f32,
    /// The target is reached within this distance, and never drawn within it, m.
    pub reach: f32,
    /// Reward for reaching it.
    pub bonus: f32,
    /// Steps after which an episode is truncated.
    pub max_steps: u32,
}

impl Default for Plane {
    fn default() -> Self {
        Plane {
            half_side: 5.0,
            reach: 0.5,
            bonus: 1000.0,
            max_steps: 200,
        }
    }
}

/// Reach a target among moving obstacles (paper, sections 4 and 5; equations 4 and 5), on levels of
/// rising difficulty: [`LEVELS`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Obstacles {
    /// Obstacles: axis-aligned boxes.
    pub count: u32,
    /// Their sides are drawn uniformly between these, m.
    pub side_min: f32,
    pub side_max: f32,
    /// Half the side of the square around the start in which their centres are drawn and stay, m.
    pub square: f32,
    /// Distance they keep from the start when they are drawn, m.
    pub margin: f32,
    /// Their speed on the last level, m/s; on the first they stand.
    pub speed: f32,
    pub motion: Motion,
    /// Half the side of the square of targets around the start, on the first and the last level, m.
    pub half_side_first: f32,
    pub half_side_last: f32,
    /// Width over which a cell of the maps rises from 0 to 1 across an obstacle's edge, m. At 0 it is 1
    /// if its centre lies in an obstacle, and else 0 (the paper's binary sensors).
    pub edge: f32,
    /// The second map shows where obstacles were so long ago, from where the character is now, s. At 0
    /// it is the map of the previous step, as it was seen then (the paper's).
    pub look_back: f32,
    /// Targets lie in no obstacle when they are drawn.
    pub target_clear: bool,
    /// The target is reached within this distance, and never drawn within it, m.
    pub reach: f32,
    /// Steps after which an episode is truncated.
    pub max_steps: u32,
    pub reward: Reward,
    /// Reward for asking for positions outside obstacles: times exp(-hits).
    pub hit_reward: f32,
    /// Times exp(-hits) - 1 instead, so that it is a penalty.
    pub hit_shift: bool,
    /// Reward for reaching the target.
    pub success_bonus: f32,
    pub arrival: Arrival,
    /// Reward for running into an obstacle.
    pub collision: f32,
    /// Begin on the first level and rise; without it all is on the last level.
    pub curriculum: bool,
    /// Success at which a level is passed.
    pub pass: f32,
}

/// Speeds of obstacles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Motion {
    /// All at the level's speed.
    Same,
    /// Each at its own, drawn uniformly up to the level's.
    Uniform,
}

/// What is rewarded at every step, besides the hit reward.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Reward {
    /// Being near the target: exp(-distance) (equation 4).
    Paper,
    /// Coming nearer: [`PROGRESS`] a metre.
    Progress,
}

/// What an arrival is worth besides its bonus.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Arrival {
    /// Nothing follows.
    Terminal,
    /// Valued as if the walk went on.
    Continue,
}

/// Reward a metre.
pub const PROGRESS: f32 = 4.0;
/// Levels of the curriculum; the last is the hardest.
pub const LEVELS: u32 = 10;

impl Obstacles {
    /// The paper's numbers and its reward as printed.
    pub const PRINTED: Obstacles = Obstacles {
        count: 100,
        side_min: 0.5,
        side_max: 3.0,
        square: 10.0,
        margin: 0.5,
        speed: 0.5,
        motion: Motion::Same,
        half_side_first: 2.5,
        half_side_last: 5.0,
        edge: 0.0,
        look_back: 0.0,
        target_clear: false,
        reach: 0.5,
        max_steps: 1000,
        reward: Reward::Paper,
        hit_reward: 1.0,
        hit_shift: false,
        success_bonus: 10.0,
        arrival: Arrival::Terminal,
        collision: 0.0,
        curriculum: true,
        pass: 0.4,
    };

    /// The reading of the paper's reward that can be learned from: as printed, standing about pays
    /// (`BENCHMARKS.md` compares them).
    pub const PAPER: Obstacles = Obstacles {
        target_clear: true,
        hit_shift: true,
        arrival: Arrival::Continue,
        ..Self::PRINTED
    };

    /// What trains best.
    pub const FAST: Obstacles = Obstacles {
        target_clear: true,
        edge: 0.375,
        look_back: 0.2,
        reward: Reward::Progress,
        hit_reward: 0.1,
        hit_shift: true,
        collision: -10.0,
        ..Self::PRINTED
    };
}

impl LocomotionTask {
    /// As on the command line.
    pub fn name(&self) -> &'static str {
        match self {
            LocomotionTask::Plane(_) => "plane",
            LocomotionTask::Obstacles(_) => "obstacles",
        }
    }

    /// Whether an observation has obstacle maps.
    pub fn has_maps(&self) -> bool {
        matches!(self, LocomotionTask::Obstacles(_))
    }

    /// Obstacles of an environment.
    pub fn obstacles(&self) -> usize {
        match self {
            LocomotionTask::Plane(_) => 0,
            LocomotionTask::Obstacles(obstacles) => obstacles.count as usize,
        }
    }

    pub fn max_steps(&self) -> u32 {
        match self {
            LocomotionTask::Plane(plane) => plane.max_steps,
            LocomotionTask::Obstacles(obstacles) => obstacles.max_steps,
        }
    }

    /// The curriculum of a training, if the task has levels.
    pub fn curriculum(&self) -> Option<Curriculum> {
        match self {
            LocomotionTask::Plane(_) => None,
            LocomotionTask::Obstacles(obstacles) => {
                let first = if obstacles.curriculum { 0 } else { LEVELS - 1 };
                Some(Curriculum::new(LEVELS, first, obstacles.pass))
            }
        }
    }

    /// Half the side of the square of targets on a level, m.
    pub fn half_side(&self, level: u32) -> f32 {
        match self {
            LocomotionTask::Plane(plane) => plane.half_side,
            LocomotionTask::Obstacles(obstacles) => {
                let (first, last) = (obstacles.half_side_first, obstacles.half_side_last);
                first + (last - first) * level as f32 / (LEVELS - 1) as f32
            }
        }
    }

    /// Ends after which the value of the last real state goes on, `1 << end` each.
    pub fn bootstrap(&self) -> u32 {
        let arrival = match self {
            LocomotionTask::Obstacles(obstacles) => obstacles.arrival,
            LocomotionTask::Plane(_) => Arrival::Terminal,
        };
        match arrival {
            Arrival::Terminal => 1 << termination::TRUNCATED,
            Arrival::Continue => 1 << termination::TRUNCATED | 1 << termination::SUCCESS,
        }
    }
}
