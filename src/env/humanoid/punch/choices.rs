//! The choices of the tasks.

use crate::env::humanoid::task::{DT, EpisodeRules, check_range};
use serde::{Deserialize, Serialize};

/// How the way to a far target is rewarded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FarReward {
    /// The paper's product, whose distance factor is nothing beyond 3 m.
    Printed,
    /// The product, with 1 / (1 + distance).
    Slow,
    /// A sum with a slope everywhere, of the speed toward the target.
    Additive,
    /// A sum with a slope everywhere, of the difference from the wanted velocity, as far as facing is as wanted.
    Velocity,
}

/// What hits the target.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Hit {
    /// Toppling it anyhow.
    Tilt,
    /// Toppling it by a first contact of a fast hand.
    Fist,
}

/// Choices of the tasks `punch` and `joystick`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Punch {
    /// Length and failures of an episode.
    #[serde(flatten)]
    pub rules: EpisodeRules,
    /// Fraction of the targets that stand near.
    pub near_share: f32,
    /// Least and largest distance of these, m.
    pub near_distance: [f32; 2],
    /// Largest bearing of these from the heading, rad.
    pub near_bearing: f32,
    /// Least and largest distance of the others, m, whose bearing is any.
    pub distance: [f32; 2],
    /// How the way to a far target is rewarded.
    pub far: FarReward,
    /// Weight of the reward for a far target.
    pub far_weight: f32,
    /// How often the wanted facing of `joystick` is near the way: 1 draws every facing alike, larger numbers favour
    /// those near it.
    pub facing_power: f32,
    /// Whether facing is rewarded.
    pub facing: bool,
    /// Wanted speed on the way, m/s; additive rewards want to be quick.
    pub speed: f32,
    /// Distance below which hands are rewarded, m.
    pub near: f32,
    /// What hits the target.
    pub hit: Hit,
    /// Speed below which a hand is no fist, m/s.
    pub fist_speed: f32,
    /// Speed of a hand toward a near target at which its reward is largest, m/s.
    pub hand_speed: f32,
    /// Time for which an episode goes on after a hit, s.
    pub after_hit_s: f32,
}

impl Default for Punch {
    fn default() -> Self {
        Punch {
            rules: EpisodeRules {
                episode_s: 15.0,
                ..EpisodeRules::default()
            },
            near_share: 0.5,
            near_distance: [0.6, 1.2],
            near_bearing: 1.0,
            distance: [1.2, 10.0],
            far: FarReward::Additive,
            far_weight: 0.3,
            facing_power: 1.0,
            facing: true,
            speed: 1.2,
            near: 1.2,
            hit: Hit::Tilt,
            fist_speed: 3.0,
            hand_speed: 1.0,
            after_hit_s: 2.0,
        }
    }
}

impl Punch {
    /// Choices with the targets of an evaluation: all between 5 and 10 m away, at any bearing; toppled anyhow,
    /// since it tells those that a fist topples.
    pub fn evaluated(self) -> Self {
        Punch {
            near_share: 0.0,
            distance: [5.0, 10.0],
            facing_power: 1.0,
            hit: Hit::Tilt,
            ..self
        }
    }

    /// Steps for which an episode goes on after a hit.
    pub fn steps_after_hit(&self) -> u32 {
        (self.after_hit_s / DT).round() as u32
    }

    /// Whether the choices can be played.
    ///
    /// # Errors
    /// The first that cannot.
    pub fn check(&self) -> Result<(), String> {
        self.rules.check()?;
        check_range(&[
            ("near_share", self.near_share),
            ("near_distance", self.near_distance[0]),
            ("near_distance", self.near_distance[1]),
            ("near_bearing", self.near_bearing),
            ("distance", self.distance[0]),
            ("distance", self.distance[1]),
            ("speed", self.speed),
            ("near", self.near),
            ("fist_speed", self.fist_speed),
            ("after_hit_s", self.after_hit_s),
            ("far_weight", self.far_weight),
        ])?;
        if !(1.0..=100.0).contains(&self.facing_power) {
            return Err("facing_power must lie between 1 and 100".into());
        }
        for (name, speed) in [("speed", self.speed), ("hand_speed", self.hand_speed)] {
            if speed < 0.01 {
                return Err(format!("{name} must be at least 0.01 m/s"));
            }
        }
        for (name, [least, most]) in [
            ("near_distance", self.near_distance),
            ("distance", self.distance),
        ] {
            // Nearer, the box would begin within the body.
            if least < 0.5 || least > most {
                return Err(format!(
                    "{name} must be two distances of at least 0.5 m, the smaller first"
                ));
            }
        }
        match self.near_share <= 1.0 {
            true => Ok(()),
            false => Err("near_share must not exceed 1".into()),
        }
    }
}
