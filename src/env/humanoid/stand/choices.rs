//! The choices of the task.

use crate::env::humanoid::starts::StartSpread;
use crate::env::humanoid::task::{EpisodeRules, check_range};
use serde::{Deserialize, Serialize};

/// Choices of the task.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Stand {
    /// Length and failures of an episode.
    #[serde(flatten)]
    pub rules: EpisodeRules,
    /// Reward of a step for being up.
    pub alive_reward: f32,
    /// Reward of a step for the torso's up axis pointing up, falling with the cosine between them.
    pub upright_reward: f32,
    /// Reward of a step for joints that do not move, falling with their mean square speed.
    pub stillness_reward: f32,
    /// Least impulse of a push on the torso, N s. Pushes come every one to two seconds, in any
    /// horizontal direction, and last a step.
    pub min_push: f32,
    /// Largest impulse of a push, N s.
    pub max_push: f32,
    /// Largest angle by which the joints of a start differ from standing about each axis (hinges: twice),
    /// rad.
    pub start_joint_angle: f32,
    /// Largest tilt of the root of a start about each horizontal axis, rad.
    pub start_tilt: f32,
    /// Largest speed of the root of a start along and about each axis, m/s and rad/s.
    pub start_root_speed: f32,
    /// Largest speed of the joints of a start, rad/s.
    pub start_joint_speed: f32,
}

impl Default for Stand {
    fn default() -> Self {
        Stand {
            rules: EpisodeRules::default(),
            alive_reward: 0.3,
            upright_reward: 0.5,
            stillness_reward: 0.2,
            min_push: 2.0,
            max_push: 4.0,
            start_joint_angle: 0.08,
            start_tilt: 0.03,
            start_root_speed: 0.1,
            start_joint_speed: 0.2,
        }
    }
}

impl Stand {
    /// Whether the choices can be played.
    ///
    /// # Errors
    /// The first that cannot.
    pub fn check(&self) -> Result<(), String> {
        self.rules.check()?;
        check_range(&[
            ("alive_reward", self.alive_reward),
            ("upright_reward", self.upright_reward),
            ("stillness_reward", self.stillness_reward),
            ("min_push", self.min_push),
            ("max_push", self.max_push),
            ("start_joint_angle", self.start_joint_angle),
            ("start_tilt", self.start_tilt),
            ("start_root_speed", self.start_root_speed),
            ("start_joint_speed", self.start_joint_speed),
        ])?;
        match self.min_push > self.max_push {
            true => Err("min_push must not exceed max_push".into()),
            false => Ok(()),
        }
    }

    /// The spread of the starts.
    pub fn start_spread(&self) -> StartSpread {
        StartSpread {
            joint: self.start_joint_angle,
            tilt: self.start_tilt,
            root_speed: self.start_root_speed,
            joint_speed: self.start_joint_speed,
        }
    }
}
