//! How a bout stands, step by step, for whoever watches it.

use super::BoxingTask;
use crate::env::VecEnv;
use crate::env::humanoid::batch::SimulatedWorld;
use crate::env::humanoid::task::{CpuHumanoidEnv, HumanoidTask};
use crate::kernels::humanoid::boxing_reward::leads;
use crate::kernels::humanoid::boxing_state::{DAMAGE, KNOCKDOWNS};
use crate::kernels::humanoid::fighters::FIGHTERS;
use crate::physics::kinematics::kinematics;
use crate::physics::model::{GeomShape, Model};
use crate::physics::pose::Pose;
use crate::physics::spatial::Spatial;
use glam::Vec3;

/// Steps for which a strike is remembered: a fifth of a second.
pub const REMEMBERED: u32 = 6;

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
    /// What there was in the bouts before.
    pub before: Tally,
}

/// What bouts that are over came to. Two numbers are those of red and blue.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tally {
    /// Bouts that each has won.
    pub won: [u32; FIGHTERS],
    /// Knock-downs by each.
    pub knockdowns: [u32; FIGHTERS],
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
            before: self.before,
        }
    }

    /// The end of the bout by a step after which the world is that of the next one: `tally` is what this one came to.
    pub fn ended(&self, tally: &Tally) -> Bout {
        Bout {
            knockdowns: tally.knockdowns,
            ..self.clone()
        }
    }

    /// The beginning of the next bout, after one that came to a `tally`.
    pub fn over(&self, tally: &Tally) -> Bout {
        let sum =
            |a: [u32; FIGHTERS], b: [u32; FIGHTERS]| [0, 1].map(|fighter| a[fighter] + b[fighter]);
        Bout {
            before: Tally {
                won: sum(self.before.won, tally.won),
                knockdowns: sum(self.before.knockdowns, tally.knockdowns),
            },
            ..Bout::default()
        }
    }

    /// Who would win if the bout ended now: who has knocked the other down more often or, that being equal, done more
    /// damage.
    pub fn leader(&self) -> Option<usize> {
        let knockdowns = self.knockdowns.map(|count| count as f32);
        (0..FIGHTERS).find(|&fighter| leads(fighter, knockdowns, self.damage))
    }
}

/// What the bouts came to that have ended in an environment, the only one, since its statistics were last taken.
pub fn tally(env: &CpuHumanoidEnv) -> Tally {
    let (names, sums) = (env.stat_names(), env.row_stats());
    let of = |name: &str| {
        let stat = names.iter().position(|other| *other == name);
        let both = stat.zip(sums.as_ref());
        let both = both.map(|(stat, sums)| &sums.host()[stat * FIGHTERS..][..FIGHTERS]);
        [0, 1].map(|fighter| both.map_or(0, |both| both[fighter] as u32))
    };
    Tally {
        won: of("successes"),
        knockdowns: of("knockdowns"),
    }
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
        at: poses[hand].position + radius(model, hand) * force.normalize_or_zero(),
        force: force.length(),
        age: 0,
    });
    strikes
        .filter(|strike| strike.force > task.boxing().blow_force)
        .collect()
}

/// Radius of a body that is a ball, m.
fn radius(model: &Model, body: usize) -> f32 {
    let mut shapes = model.geoms.iter().filter(|geom| geom.body == Some(body));
    let ball = shapes.find_map(|geom| match geom.shape {
        GeomShape::Sphere { radius } => Some(radius),
        _ => None,
    });
    ball.unwrap_or(0.0)
}
