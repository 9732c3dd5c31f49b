//! The choices of the task.

use crate::env::humanoid::task::{DT, EpisodeRules, check_range};
use crate::kernels::humanoid::place_fighters::MARGIN;
use serde::{Deserialize, Serialize};

/// Choices of the task `box`. Its reward is that of Son and Kwon (2023), equations 11 to 19, with what makes it
/// learnable; [`Boxing::printed`] has it as printed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Boxing {
    /// Length of a bout, and when a fighter has fallen.
    #[serde(flatten)]
    pub rules: EpisodeRules,
    /// Half the width of the arena, m.
    pub arena: f32,
    /// Least and largest distance of a start from the arena's centre, m.
    pub start_distance: [f32; 2],
    /// Distance below which fighters are near, and engaged, m.
    pub near: f32,
    /// Wanted speed toward an opponent that is far, m/s.
    pub speed: f32,
    /// Whether a fall ends the bout.
    pub fall_ends: bool,
    /// Whether the way to a far opponent is rewarded by a [sum](crate::kernels::humanoid::approach::approach) with a
    /// slope everywhere, or as printed.
    pub additive: bool,
    /// Weight of the reward for an opponent that is far.
    pub far_weight: f32,
    /// Whether facing is rewarded, and required for the reward of an opponent that is about to fall.
    pub facing: bool,
    /// Reward of the step that knocks the opponent down.
    pub knockdown_bonus: f32,
    /// Time after a blow in which a fall is a knock-down, s; 0 if every fall is one. Falls that are nobody's doing
    /// make a poor teacher.
    pub stagger_s: f32,
    /// Force of the hands on torso and head above which a touch is a blow, N.
    pub blow_force: f32,
    /// Factor of the forces in the reward.
    pub damage_scale: f32,
    /// Weight of the forces taken against those given, in the beginning and after `anneal_steps`: who fears them
    /// before it can punch learns to run away.
    pub damage_taken: [f32; 2],
    /// Weight of all that is neither damage nor penalty nor a knock-down, in the beginning and after
    /// `anneal_steps`.
    pub dense: [f32; 2],
    /// Steps of an environment over which `damage_taken` and `dense` change.
    pub anneal_steps: u32,
    /// Weight of the damage (table 3).
    pub damage_weight: f32,
    /// Weight of a hand that approaches torso or head (table 3).
    pub close_weight: f32,
    /// Weight of facing each other (table 3).
    pub facing_weight: f32,
    /// Weight of an opponent that is about to fall (table 3).
    pub fall_weight: f32,
    /// Weight of the energy spent (table 3).
    pub energy_weight: f32,
    /// Weight of having fallen or left the arena (table 3).
    pub penalty_weight: f32,
    /// Distance below which fighters that stay there are in a clinch, m.
    pub clinch_distance: f32,
    /// Time that they stay there before it is one, s.
    pub clinch_s: f32,
}

impl Default for Boxing {
    fn default() -> Self {
        Boxing {
            rules: EpisodeRules {
                episode_s: 50.0,
                ..EpisodeRules::default()
            },
            arena: 3.0,
            start_distance: [1.0, 3.0],
            near: 1.75,
            speed: 1.2,
            fall_ends: true,
            additive: true,
            // Closeness and facing give up to 14.
            far_weight: 3.0,
            facing: true,
            // Being close and face to face for a whole bout is worth 2,300 at a discount of .994, that of a decision of
            // five steps being .97: a clinch must not pay more than winning.
            knockdown_bonus: 3000.0,
            stagger_s: 1.0,
            // A twentieth of a fighter's weight.
            blow_force: 25.0,
            damage_scale: 0.01,
            damage_taken: [0.0, 2.0],
            dense: [1.0, 0.25],
            // Half of a training of 512 environments.
            anneal_steps: 20_000,
            damage_weight: 1.0,
            close_weight: 4.0,
            facing_weight: 10.0,
            fall_weight: 200.0,
            // In proportion to the damage it is weighed against. The printed weight takes 23 from every step of somebody
            // who moves as the performer's boxing does, more than closeness and facing give.
            energy_weight: 1e-5,
            penalty_weight: 30.0,
            clinch_distance: 0.5,
            clinch_s: 1.0,
        }
    }
}

impl Boxing {
    /// The reward as it is printed.
    pub fn printed() -> Self {
        Boxing {
            additive: false,
            far_weight: 1.0,
            knockdown_bonus: 500.0,
            stagger_s: 0.0,
            damage_scale: 1.0,
            damage_taken: [2.0, 2.0],
            dense: [1.0, 1.0],
            energy_weight: 1e-3,
            ..Boxing::default()
        }
    }

    /// Weight of the forces taken after so many steps of an environment.
    pub fn damage_taken_at(&self, step: u32) -> f32 {
        self.annealed(self.damage_taken, step)
    }

    /// Weight of the dense rewards after so many steps of an environment.
    pub fn dense_at(&self, step: u32) -> f32 {
        self.annealed(self.dense, step)
    }

    fn annealed(&self, [first, last]: [f32; 2], step: u32) -> f32 {
        let part = step as f32 / self.anneal_steps.max(1) as f32;
        match step < self.anneal_steps {
            true => first + (last - first) * part,
            false => last,
        }
    }

    /// The bonus of a knock-down over what a bout without one is worth at the discount `gamma`, when both are close
    /// and face each other all the time: below 1, clinching pays more than winning.
    pub fn bonus_ratio(&self, gamma: f32) -> f32 {
        let discounted: f32 = (0..self.rules.steps())
            .scan(1.0, |weight, _| {
                Some(std::mem::replace(weight, *weight * gamma))
            })
            .sum();
        let facing = if self.facing { self.facing_weight } else { 0.0 };
        let dense = self.dense[0].max(self.dense[1]) * (self.close_weight + facing);
        self.knockdown_bonus / (dense * discounted).max(f32::MIN_POSITIVE)
    }

    /// Steps after which fighters within `clinch_distance` are in a clinch.
    pub fn clinch_steps(&self) -> u32 {
        ((self.clinch_s / DT).round() as u32).max(1)
    }

    /// Steps after a blow in which a fall is a knock-down; 0 if every fall is one.
    pub fn stagger_steps(&self) -> u32 {
        match self.stagger_s > 0.0 {
            true => ((self.stagger_s / DT).round() as u32).max(1),
            false => 0,
        }
    }

    /// Whether the choices can be played.
    ///
    /// # Errors
    /// The first that cannot.
    pub fn check(&self) -> Result<(), String> {
        self.rules.check()?;
        check_range(&[
            ("arena", self.arena),
            ("start_distance", self.start_distance[0]),
            ("start_distance", self.start_distance[1]),
            ("near", self.near),
            ("speed", self.speed),
            ("far_weight", self.far_weight),
            ("stagger_s", self.stagger_s),
            ("blow_force", self.blow_force),
            ("damage_scale", self.damage_scale),
            ("damage_taken", self.damage_taken[0]),
            ("damage_taken", self.damage_taken[1]),
            ("dense", self.dense[0]),
            ("dense", self.dense[1]),
            ("damage_weight", self.damage_weight),
            ("close_weight", self.close_weight),
            ("facing_weight", self.facing_weight),
            ("fall_weight", self.fall_weight),
            ("energy_weight", self.energy_weight),
            ("penalty_weight", self.penalty_weight),
            ("clinch_distance", self.clinch_distance),
            ("clinch_s", self.clinch_s),
        ])?;
        if !(0.0..=1e6).contains(&self.knockdown_bonus) {
            return Err("knockdown_bonus must lie between 0 and 1000000".into());
        }
        let [least, most] = self.start_distance;
        // Nearer, the fighters would begin within each other.
        if least < 0.5 || least > most {
            return Err(
                "start_distance must be two distances of at least 0.5 m, the smaller first".into(),
            );
        }
        let reach = most.max(least + MARGIN);
        match self.arena >= reach {
            true => Ok(()),
            false => Err(format!(
                "an arena of {} m to each side is too small to start in: it must reach {reach} m from its centre",
                self.arena
            )),
        }
    }
}
