//! How a bout stands, step by step, for whoever watches it.

use super::BoxingTask;
use crate::env::VecEnv;
use crate::env::humanoid::batch::SimulatedWorld;
use crate::env::humanoid::task::{CpuHumanoidEnv, HumanoidTask};
use crate::kernels::humanoid::boxing_state::{DAMAGE, KNOCKDOWNS};
use crate::kernels::humanoid::fighters::FIGHTERS;
use crate::physics::kinematics::kinematics;
use crate::physics::pose::Pose;
use crate::physics::spatial::Spatial;
use anyhow::Result;
use glam::Vec3;

/// Steps for which a strike is remembered: a fifth of a second.
pub const REMEMBERED: u32 = 6;
/// The weakest force that is a strike and not a touch, N: a twentieth of a fighter's weight.
const WEAKEST: f32 = 25.0;
/// Radius of a hand, m.
const HAND: f32 = 0.04;

/// A hand on the other's torso or head.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strike {
    /// Where the hand touches, m.
    pub at: Vec3,
    /// Mean force over its step, N.
    pub force: f32,
    /// Steps ago.
    pub age: u32,
}

/// A bout at one moment. Two numbers are those of red and blue.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bout {
    /// Impulse of each one's hands on the other's torso and head, N s.
    pub damage: [f32; FIGHTERS],
    /// Knock-downs by each.
    pub knockdowns: [u32; FIGHTERS],
    /// Strikes of the last steps.
    pub strikes: Vec<Strike>,
    /// Bouts before this one that each has won.
    pub won: [u32; FIGHTERS],
}

impl Bout {
    /// The bout a step later: of a world with the task's `state` after the step.
    pub fn next(&self, task: &BoxingTask, world: &SimulatedWorld, state: &[f32]) -> Bout {
        let older = self.strikes.iter().map(|strike| Strike {
            age: strike.age + 1,
            ..*strike
        });
        let older = older.filter(|strike| strike.age < REMEMBERED);
        Bout {
            damage: [0, 1].map(|fighter| state[DAMAGE + fighter]),
            knockdowns: [0, 1].map(|fighter| state[KNOCKDOWNS + fighter] as u32),
            strikes: older.chain(strikes(task, world)).collect(),
            won: self.won,
        }
    }

    /// The beginning of the next bout, after one that these have won.
    pub fn over(&self, winners: [bool; FIGHTERS]) -> Bout {
        Bout {
            won: [0, 1].map(|fighter| self.won[fighter] + u32::from(winners[fighter])),
            ..Bout::default()
        }
    }

    /// Who would win if the bout ended now: who has knocked the other down more often or, that being equal, done more
    /// damage.
    pub fn leader(&self) -> Option<usize> {
        let [red, blue] = [0, 1].map(|fighter| (self.knockdowns[fighter], self.damage[fighter]));
        match (red > blue, blue > red) {
            (true, _) => Some(0),
            (_, true) => Some(1),
            _ => None,
        }
    }
}

/// Who has won the bouts that have ended in an environment, the only one, since its statistics were last taken.
///
/// # Errors
/// None: the environment is on the host.
pub fn winners(env: &CpuHumanoidEnv) -> Result<[bool; FIGHTERS]> {
    let (names, stats) = (env.stat_names(), env.row_stats()?);
    let successes = names.iter().position(|name| *name == "successes");
    let of = |fighter: usize| successes.map(|stat| stats[fighter * names.len() + stat]);
    Ok([0, 1].map(|fighter| of(fighter).is_some_and(|won| won > 0.0)))
}

/// The strikes of the last step.
fn strikes(task: &BoxingTask, world: &SimulatedWorld) -> Vec<Strike> {
    let model = task.model();
    let mut poses = vec![Pose::default(); model.bodies.len()];
    let mut axes = vec![Spatial::ZERO; model.nv()];
    kinematics(model, &world.state.q, &mut poses, &mut axes);
    let forces = world.pair_forces(model.bodies.len());
    let hits = task.force_pairs().into_iter().zip(forces);
    let strikes = hits.map(|([hand, _], force)| Strike {
        at: poses[hand].position + HAND * force.normalize_or_zero(),
        force: force.length(),
        age: 0,
    });
    strikes.filter(|strike| strike.force > WEAKEST).collect()
}
