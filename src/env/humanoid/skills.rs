//! How well a policy of skills does what its latents say.

use super::driver::{BodyDriver, DriverState};
use super::fidelity::{FidelityProbe, FidelityReport};
use super::imitate::{ImitateTask, evaluate as evaluate_imitation};
use super::task::play::play_episodes;
use super::task::{CpuHumanoidEnv, DT};
use crate::kernels::termination::FAILED;
use crate::physics::motion_library::MotionLibrary;
use serde::Serialize;
use std::sync::Arc;

/// Latents of which each is kept for a whole episode, and episodes of each.
const REPEATED: [usize; 2] = [16, 4];
/// The most episodes whose latents change every second.
const CHANGING: usize = 256;
/// Seconds of an episode after which a body should do what its latent says.
const SETTLED_S: usize = 2;

/// How well a policy of skills does what its latents say.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SkillReport {
    /// Under latents that change as in training.
    #[serde(flatten)]
    pub fidelity: FidelityReport,
    /// Fraction of the episodes without a fall under latents that change every second.
    pub survival_changing: f64,
    /// Under latents that are kept: the fraction of stretches of a second whose nearest clip is the one that is
    /// most often nearest under the same latent.
    pub repeatability: f64,
}

/// Plays `episodes` episodes under changing latents, and some under latents that are kept. All depend on `seed`
/// alone.
pub fn evaluate(
    task: Arc<ImitateTask>,
    library: &MotionLibrary,
    driver: &dyn BodyDriver,
    episodes: usize,
    seed: u32,
) -> SkillReport {
    SkillReport {
        fidelity: evaluate_imitation(task.clone(), driver, episodes, seed),
        survival_changing: survival_changing(task.clone(), driver, episodes.min(CHANGING), seed),
        repeatability: repeatability(task, library, driver, seed),
    }
}

fn survival_changing(
    task: Arc<ImitateTask>,
    driver: &dyn BodyDriver,
    episodes: usize,
    seed: u32,
) -> f64 {
    let mut envs = CpuHumanoidEnv::unstaggered(task, 0..episodes, seed);
    let second = (1.0 / DT).round() as u32;
    let start = DriverState::default();
    let found = play_episodes(&mut envs, driver, start, |_, _, state| {
        let over = state.steps as u32 % second == 0;
        state.kept.fill(if over { 0 } else { second });
    });
    1.0 - found.fraction(1 << FAILED)
}

fn repeatability(
    task: Arc<ImitateTask>,
    library: &MotionLibrary,
    driver: &dyn BodyDriver,
    seed: u32,
) -> f64 {
    let [latents, repeats] = REPEATED;
    let mut envs = CpuHumanoidEnv::unstaggered(task, 0..latents * repeats, seed);
    let mut probe = FidelityProbe::new(library, &envs);
    let start = DriverState::default();
    play_episodes(&mut envs, driver, start, |envs, running, state| {
        if state.steps == 1 {
            repeat(&mut state.latents, repeats * latents, repeats);
        }
        state.kept.fill(u32::MAX);
        probe.observe(envs, running);
    });
    let nearest = probe.nearest_clips();
    let shares: Vec<f64> = nearest
        .chunks(repeats)
        .filter_map(|episodes| {
            let settled = episodes.iter().flat_map(|clips| clips.iter().skip(SETTLED_S));
            share_of_most_frequent(&settled.copied().collect::<Vec<_>>())
        })
        .collect();
    shares.iter().sum::<f64>() / shares.len().max(1) as f64
}

/// Gives every so many rows the latent of the first of them.
fn repeat(latents: &mut [f32], rows: usize, every: usize) {
    let dim = latents.len() / rows;
    for group in latents.chunks_mut(dim * every) {
        let (first, rest) = group.split_at_mut(dim);
        rest.chunks_exact_mut(dim)
            .for_each(|latent| latent.copy_from_slice(first));
    }
}

/// How large a part the most frequent number has; `None` of nothing.
fn share_of_most_frequent(numbers: &[usize]) -> Option<f64> {
    let count = |number: &usize| numbers.iter().filter(|other| *other == number).count();
    let most = numbers.iter().map(count).max()?;
    Some(most as f64 / numbers.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repeated_latents_are_those_of_the_first() {
        let mut latents = vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0];
        repeat(&mut latents, 4, 2);
        assert_eq!(latents, [1.0, 2.0, 1.0, 2.0, 5.0, 6.0, 5.0, 6.0]);
    }

    #[test]
    fn shares_of_the_most_frequent() {
        assert_eq!(share_of_most_frequent(&[]), None);
        assert_eq!(share_of_most_frequent(&[3, 1, 3, 2]), Some(0.5));
    }
}
