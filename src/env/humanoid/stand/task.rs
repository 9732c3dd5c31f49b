//! The choices of the task, and its dimensions.

use crate::env::humanoid::starts::StartSpread;
use crate::env::spec::{EnvSpec, ObservationSpec};
use crate::kernels::physics::proprioception;
use crate::kernels::termination;
use crate::physics::scenes;
use crate::physics::simulator::{STEP_RATE, SUBSTEPS};
use serde::{Deserialize, Serialize};

/// Length of a step, s.
pub const DT: f32 = SUBSTEPS as f32 / STEP_RATE;

/// Bodies whose positions are observed.
pub const KEY_BODIES: [&str; 4] = ["right_hand", "left_hand", "right_foot", "left_foot"];

/// Choices of the task.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Stand {
    /// Length of an episode, s; it then ends as a success.
    pub episode_s: f32,
    /// Height of the head below which the character has fallen, m.
    pub min_head_height: f32,
    /// Height of the pelvis below which it has fallen, m.
    pub min_pelvis_height: f32,
    /// Height of any body but the feet below which it has fallen, m.
    pub min_body_height: f32,
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
            episode_s: 10.0,
            min_head_height: 0.9,
            min_pelvis_height: 0.5,
            min_body_height: 0.15,
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
    /// Steps of an episode, which is also as long as a rollout may be: there is room for one final
    /// observation of each environment.
    pub fn episode_steps(&self) -> u32 {
        (self.episode_s / DT).round() as u32
    }

    /// Whether the choices can be played.
    ///
    /// # Errors
    /// The first that cannot.
    pub fn check(&self) -> Result<(), String> {
        if !(DT..=3600.0).contains(&self.episode_s) {
            return Err("episode_s must lie between 0.04 and 3600 s".into());
        }
        let rest = [
            ("min_head_height", self.min_head_height),
            ("min_pelvis_height", self.min_pelvis_height),
            ("min_body_height", self.min_body_height),
            ("alive_reward", self.alive_reward),
            ("upright_reward", self.upright_reward),
            ("stillness_reward", self.stillness_reward),
            ("min_push", self.min_push),
            ("max_push", self.max_push),
            ("start_joint_angle", self.start_joint_angle),
            ("start_tilt", self.start_tilt),
            ("start_root_speed", self.start_root_speed),
            ("start_joint_speed", self.start_joint_speed),
        ];
        let fits = |value: f32| (0.0..=1000.0).contains(&value);
        match rest.iter().find(|(_, value)| !fits(*value)) {
            Some((name, _)) => Err(format!("{name} must lie between 0 and 1000")),
            None if self.min_push > self.max_push => {
                Err("min_push must not exceed max_push".into())
            }
            None => Ok(()),
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

/// The dimensions of `envs` environments.
pub fn spec(envs: usize) -> EnvSpec {
    let model = scenes::humanoid();
    EnvSpec {
        envs,
        agents: 1,
        observation: ObservationSpec {
            vector: proprioception::width(&model, 0, KEY_BODIES.len()),
            grid: None,
        },
        action: model.nu(),
        dt: DT,
        bootstrap: 1 << termination::TRUNCATED,
        bootstraps_often: false,
    }
}
