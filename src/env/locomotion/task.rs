//! What is asked of the character.

use crate::env::curriculum::Curriculum;
use crate::kernels::termination;
use serde::{Deserialize, Serialize};

/// A task with its choices.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LocomotionTask {
    /// A target on an empty plane.
    Plane(Plane),
    /// A target among moving obstacles.
    Obstacles(Obstacles),
}

/// Reach a target on an empty plane (paper, section 3; equation 3).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plane {
    /// Half the side of the square around the start from which targets are drawn uniformly, m.
    pub target_extent: f32,
    /// The target is reached within this distance, and never drawn within it, m.
    pub success_radius: f32,
    /// Reward for reaching it.
    pub success_bonus: f32,
    /// Steps after which an episode is truncated.
    pub max_steps: u32,
}

impl Default for Plane {
    fn default() -> Self {
        Plane {
            target_extent: 5.0,
            success_radius: 0.5,
            success_bonus: 1000.0,
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
    /// Shortest side of an obstacle, m; each side is drawn uniformly up to the longest.
    pub side_min: f32,
    /// Longest side of an obstacle, m.
    pub side_max: f32,
    /// Half the side of the square around the start in which their centres are drawn and stay, m.
    pub arena_half_extent: f32,
    /// Distance they keep from the start when they are drawn, m.
    pub spawn_clearance: f32,
    /// Their speed on the last level, m/s; on the first they stand.
    pub speed: f32,
    /// Whether all obstacles move at `speed`, or each at its own up to that.
    pub speed_distribution: SpeedDistribution,
    /// Half the side of the square of targets around the start on the first level, m.
    pub target_extent_first: f32,
    /// Half the side of that square on the last level, m; in between it grows linearly.
    pub target_extent_last: f32,
    /// Width over which a cell of the maps rises from 0 to 1 across an obstacle's edge, m. At 0 it is 1
    /// if its centre lies in an obstacle, and else 0 (the paper's binary sensors).
    pub map_edge_width: f32,
    /// The second map shows where obstacles were so long ago, from where the character is now, s. At 0
    /// it is the map of the previous step, as it was seen then (the paper's).
    pub map_history_s: f32,
    /// Targets lie in no obstacle when they are drawn.
    pub target_clear: bool,
    /// The target is reached within this distance, and never drawn within it, m.
    pub success_radius: f32,
    /// Steps after which an episode is truncated.
    pub max_steps: u32,
    /// What is rewarded at every step.
    pub reward: Reward,
    /// Reward for asking for positions outside obstacles: times exp(-hits).
    pub hit_reward: f32,
    /// Times exp(-hits) - 1 instead, so that it is never above zero.
    pub hit_reward_is_penalty: bool,
    /// Reward for reaching the target.
    pub success_bonus: f32,
    /// Nothing follows a success; without it, it is valued as if the episode went on.
    pub success_is_terminal: bool,
    /// Reward for running into an obstacle.
    pub collision_reward: f32,
    /// Begin on the first level and rise; without it all is on the last level.
    pub curriculum: bool,
    /// Success at which a level is passed.
    pub promotion_success: f32,
}

/// Speeds of obstacles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SpeedDistribution {
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
        arena_half_extent: 10.0,
        spawn_clearance: 0.5,
        speed: 0.5,
        speed_distribution: SpeedDistribution::Same,
        target_extent_first: 2.5,
        target_extent_last: 5.0,
        map_edge_width: 0.0,
        map_history_s: 0.0,
        target_clear: false,
        success_radius: 0.5,
        max_steps: 1000,
        reward: Reward::Paper,
        hit_reward: 1.0,
        hit_reward_is_penalty: false,
        success_bonus: 10.0,
        success_is_terminal: true,
        collision_reward: 0.0,
        curriculum: true,
        promotion_success: 0.4,
    };

    /// The reading of the paper's reward that can be learned from: as printed, standing about pays
    /// (`docs/measurements/2026-11-29.md` compares them).
    pub const PAPER: Obstacles = Obstacles {
        target_clear: true,
        hit_reward_is_penalty: true,
        success_is_terminal: false,
        ..Self::PRINTED
    };

    /// What trains best.
    pub const FAST: Obstacles = Obstacles {
        target_clear: true,
        map_edge_width: 0.375,
        map_history_s: 0.2,
        reward: Reward::Progress,
        hit_reward: 0.1,
        hit_reward_is_penalty: true,
        collision_reward: -10.0,
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

    /// Half the side of the square that obstacles and targets keep to, m. None on a plane without end.
    pub fn arena_half_extent(&self) -> Option<f32> {
        match self {
            LocomotionTask::Plane(_) => None,
            LocomotionTask::Obstacles(obstacles) => Some(obstacles.arena_half_extent),
        }
    }

    /// Distance within which the target is reached, m.
    pub fn success_radius(&self) -> f32 {
        match self {
            LocomotionTask::Plane(plane) => plane.success_radius,
            LocomotionTask::Obstacles(obstacles) => obstacles.success_radius,
        }
    }

    /// Obstacles of an environment.
    pub fn obstacles(&self) -> usize {
        match self {
            LocomotionTask::Plane(_) => 0,
            LocomotionTask::Obstacles(obstacles) => obstacles.count as usize,
        }
    }

    /// Steps after which an episode is truncated.
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
                Some(Curriculum::new(LEVELS, first, obstacles.promotion_success))
            }
        }
    }

    /// Half the side of the square of targets on a level, m.
    pub fn target_extent(&self, level: u32) -> f32 {
        match self {
            LocomotionTask::Plane(plane) => plane.target_extent,
            LocomotionTask::Obstacles(obstacles) => {
                let (first, last) = (obstacles.target_extent_first, obstacles.target_extent_last);
                first + (last - first) * level as f32 / (LEVELS - 1) as f32
            }
        }
    }

    /// Terminations after which the value of the final observation goes on, `1 << termination` each.
    pub fn bootstrap(&self) -> u32 {
        let success_is_terminal = match self {
            LocomotionTask::Plane(_) => true,
            LocomotionTask::Obstacles(obstacles) => obstacles.success_is_terminal,
        };
        match success_is_terminal {
            true => 1 << termination::TRUNCATED,
            false => 1 << termination::TRUNCATED | 1 << termination::SUCCESS,
        }
    }
}
