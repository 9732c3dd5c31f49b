//! How well a policy of skills does what its latents say.

use super::driver::{BodyDriver, DriverState};
use super::fidelity::{FidelityProbe, FidelityReport};
use super::imitate::{ImitateTask, evaluate as evaluate_imitation};
use super::task::play::play_episodes;
use super::task::{CpuHumanoidEnv, DT};
use crate::kernels::humanoid::end_episode::LIMIT;
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
        let over = (state.steps as u32).is_multiple_of(second);
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
            let settled = episodes
                .iter()
                .flat_map(|clips| clips.iter().skip(SETTLED_S));
            share_of_most_frequent(&settled.copied().collect::<Vec<_>>())
        })
        .collect();
    shares.iter().sum::<f64>() / shares.len().max(1) as f64
}

/// The clip that a body is most like under each of some latents that are held, in the second after it has settled;
/// `None` where it falls before that is over. Environments beyond those whose poses are compared have none.
pub fn clips_under(
    envs: &mut CpuHumanoidEnv,
    library: &MotionLibrary,
    driver: &dyn BodyDriver,
    latents: Vec<f32>,
) -> Vec<Option<usize>> {
    let second = (1.0 / DT).round() as usize;
    let settled = SETTLED_S * second;
    for episode in &mut envs.episodes {
        episode[LIMIT] = (settled + second) as f32;
    }
    let mut probe = FidelityProbe::new(library, envs);
    let start = DriverState::holding(latents, envs.batch.worlds.len());
    let found = play_episodes(envs, driver, start, |envs, running, state| {
        if state.steps > settled {
            probe.observe(envs, running);
        }
    });
    let nearest = probe.nearest_clips().into_iter().zip(found.ends);
    nearest
        .map(|(clips, end)| clips.first().copied().filter(|_| end != FAILED))
        .collect()
}

/// The most frequent of the nearest clips of an episode's seconds: of those after it has settled, if it gets so far.
pub fn settled_clip(nearest: &[usize]) -> Option<usize> {
    let settled = nearest.get(SETTLED_S..).filter(|clips| !clips.is_empty());
    most_frequent(settled.unwrap_or(nearest)).map(|(clip, _)| clip)
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
    most_frequent(numbers).map(|(_, most)| most as f64 / numbers.len() as f64)
}

/// The most frequent number, and how often it is there; `None` of nothing.
fn most_frequent(numbers: &[usize]) -> Option<(usize, usize)> {
    let count = |number: usize| numbers.iter().filter(|other| **other == number).count();
    let counts = numbers.iter().map(|&number| (number, count(number)));
    counts.max_by_key(|&(_, count)| count)
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

    #[test]
    fn a_body_that_falls_before_it_settles_is_judged_by_what_it_did() {
        assert_eq!(settled_clip(&[]), None);
        assert_eq!(settled_clip(&[4]), Some(4));
        assert_eq!(settled_clip(&[4, 4, 4, 7, 7]), Some(7));
    }
}
