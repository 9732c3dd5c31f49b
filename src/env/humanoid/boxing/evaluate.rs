//! How two drivers fare against each other.

use super::BoxingTask;
use super::corners::Corners;
use crate::env::humanoid::driver::BodyDriver;
use crate::env::humanoid::task::play::{Episodes, play_episodes_by};
use crate::env::humanoid::task::{CpuHumanoidEnv, DT};
use crate::env::{Stats, VecEnv};
use crate::kernels::humanoid::fighters::FIGHTERS;
use serde::Serialize;
use std::sync::Arc;

/// How bouts went. Two numbers are those of red and blue.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BoxingReport {
    /// Bouts played.
    pub bouts: usize,
    /// Fraction of the bouts that red won.
    pub won: f64,
    /// Fraction that blue won.
    pub lost: f64,
    /// Fraction that nobody won.
    pub drawn: f64,
    /// Mean length of a bout, s.
    pub mean_bout_s: f64,
    /// Fraction of the time in which the fighters were near each other.
    pub engagement: f64,
    /// Fraction of the damage that was done from behind.
    pub from_behind: f64,
    /// Clinches of a bout.
    pub clinches_per_bout: f64,
    /// Mean knock-downs of a bout by each.
    pub knockdowns: [f64; FIGHTERS],
    /// Mean impulse of each one's hands on the other's torso and head in a bout, N s.
    pub damage: [f64; FIGHTERS],
    /// Fraction of the bouts in which each left the arena.
    pub out: [f64; FIGHTERS],
}

/// Plays `bouts` bouts of red against blue, whose starts depend on `seed` alone.
pub fn evaluate(
    task: Arc<BoxingTask>,
    drivers: [&dyn BodyDriver; FIGHTERS],
    bouts: usize,
    seed: u32,
) -> BoxingReport {
    let mut envs = CpuHumanoidEnv::unstaggered(task, 0..bouts, seed);
    let corners = Corners::new(drivers, envs.spec().observation.dim());
    let found = play_episodes_by(
        &mut envs,
        |observation, corners: &mut Corners| corners.act(observation),
        corners,
        |_, _, _| (),
    );
    report(&found, &envs)
}

fn report(found: &Episodes, envs: &CpuHumanoidEnv) -> BoxingReport {
    let names = envs.stat_names();
    let bouts = envs.spec().envs;
    let rows = found.sums.iter().map(|sums| Stats::new(names, sums));
    let rows: Vec<Stats> = rows.collect();
    let mean = |name: &str| {
        [0, 1].map(|corner| {
            let own = rows.iter().skip(corner).step_by(FIGHTERS);
            own.map(|row| row.sum(name)).sum::<f64>() / bouts.max(1) as f64
        })
    };
    let [won, lost] = mean("successes");
    let (knockdowns, damage) = (mean("knockdowns"), mean("damage"));
    let both = |[red, blue]: [f64; FIGHTERS]| red + blue;
    let steps = mean("steps")[0];
    BoxingReport {
        bouts,
        won,
        lost,
        drawn: 1.0 - won - lost,
        mean_bout_s: steps * f64::from(DT),
        engagement: mean("engaged_steps")[0] / steps.max(1.0),
        from_behind: both(mean("damage_from_behind")) / both(damage).max(1e-9),
        clinches_per_bout: mean("clinches")[0],
        knockdowns,
        damage,
        out: mean("out"),
    }
}
