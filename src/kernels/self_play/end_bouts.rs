//! The ends of bouts, and who meets whom next. Shader: `shaders/self_play/end_bouts.wgsl`.

use super::OpponentTable;
use crate::gpu::shader::end_bouts::constants::BOUTS;
use crate::gpu::{Argument, Buffer, Gpu, groups, shader};
use crate::kernels::rng::{index_below, random4};
use crate::kernels::termination::RUNNING;

crate::shader_params! {
    pub struct Params for end_bouts {
        /// Index of successes among the statistics.
        pub successes: u32,
        /// Number of the first environment in the whole batch.
        pub first: u32,
        /// Seed of the random numbers.
        pub seed: u32,
        /// Steps of the run so far: the random numbers' counter.
        pub step_counter: u32,
    }
}

/// Queues the shader on `gpu`.
///
/// `opponents` are those of an [`OpponentTable`]. `termination` is how the step ended for every row, `[2 envs]`; `now` and
/// `before` are the sums of statistics of their episodes so far, `[stats][2 envs]`, after the step and before it. Where a
/// bout has ended, the learner's row `own` and the number of its `opponent`, `[envs]`, are drawn anew; what the
/// learner's episode came to is added to its environment's `sums`, `[stats][envs]`, and the bout to the opponent's
/// `tallies`, `[opponents][2]`: bouts, and halves of them that the learner won, two for a win and one for a draw. Bouts
/// against opponents that have left are not counted there.
pub fn launch(
    gpu: &Gpu,
    opponents: &Buffer<u32>,
    termination: &Buffer<u32>,
    now: &Buffer<f32>,
    before: &Buffer<f32>,
    own: &Buffer<u32>,
    opponent: &Buffer<u32>,
    sums: &Buffer<f32>,
    tallies: &Buffer<u32>,
    params: &Params,
) {
    let groups = groups(&shader::END_BOUTS, own.len());
    let buffers: [&dyn Argument; 8] = [
        opponents,
        termination,
        now,
        before,
        own,
        opponent,
        sums,
        tallies,
    ];
    gpu.launch(&shader::END_BOUTS, groups, &buffers, params);
}

/// The shader's computation on the host.
pub fn twin(
    opponents: &OpponentTable,
    termination: &[u32],
    now: &[f32],
    before: &[f32],
    own: &mut [u32],
    opponent: &mut [u32],
    sums: &mut [f32],
    tallies: &mut [u32],
    params: &Params,
) {
    let (envs, successes) = (opponents.envs, params.successes as usize);
    for env in 0..envs {
        let row = own[env] as usize;
        if termination[row] == RUNNING {
            continue;
        }
        let gained = |stat: usize, row: usize| {
            let at = stat * 2 * envs + row;
            now[at] - before[at]
        };
        for stat in 0..opponents.stats {
            sums[stat * envs + env] += gained(stat, row);
        }
        let index = opponents.index(opponent[env]);
        if opponents.numbers[index] == opponent[env] {
            let halves = 1.0 + gained(successes, row) - gained(successes, row ^ 1);
            tallies[2 * index] += 1;
            tallies[2 * index + 1] += halves.clamp(0.0, 2.0) as u32;
        }
        let [agent, next] = draw(opponents, env, params);
        own[env] = 2 * env as u32 + agent;
        opponent[env] = next;
    }
}

/// The learner's agent and the number of its opponent in the bout that begins in an environment.
pub fn draw(opponents: &OpponentTable, env: usize, params: &Params) -> [u32; 2] {
    let number = params.first + env as u32;
    let [agent, opponent, ..] = random4(params.seed, number, params.step_counter, BOUTS);
    let opponent = opponents.numbers[opponents.drawn(opponent)];
    [index_below(agent, 2), opponent]
}
