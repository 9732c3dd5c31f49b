//! What a learner and the policies of its opponents do, where environments want it. Shader:
//! `shaders/self_play/bout_actions.wgsl`.

use super::SCRIPTED;
use crate::gpu::{Argument, Buffer, Gpu, shader};
use crate::kernels::learn::sample_action::noise;

crate::shader_params! {
    pub struct Params for bout_actions {
        /// Environments.
        pub envs: u32,
        /// Numbers of an action.
        pub action: u32,
        /// Index of the learner's first action.
        pub at: u32,
        /// Rows of a block.
        pub block: u32,
        /// Parameters of a policy.
        pub parameters: u32,
        /// Index of the first logarithm of a standard deviation among them.
        pub log_std: u32,
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
/// `own` is the learner's row in each environment; `place` and `blocks` are those of
/// [`group_bouts`](super::group_bouts). `learner` holds `[envs][action]` from `params.at` on, `mean` `[slots][action]` of the
/// policies, whose `parameters` are `[policies][parameters]`. `action` takes `[2 envs][action]`: what the learner
/// does and what the policies draw; rows of scripts are left as they are.
pub fn launch(
    gpu: &Gpu,
    own: &Buffer<u32>,
    place: &Buffer<u32>,
    blocks: &Buffer<u32>,
    learner: &Buffer<f32>,
    mean: &Buffer<f32>,
    parameters: &Buffer<f32>,
    action: &Buffer<f32>,
    params: &Params,
) {
    let [across, down, _] = shader::BOUT_ACTIONS.workgroup;
    let groups = [
        params.action.div_ceil(across),
        params.envs.div_ceil(down),
        1,
    ];
    let buffers: [&dyn Argument; 7] = [own, place, blocks, learner, mean, parameters, action];
    gpu.launch(&shader::BOUT_ACTIONS, groups, &buffers, params);
}

/// The shader's computation on the host.
pub fn twin(
    own: &[u32],
    place: &[u32],
    blocks: &[u32],
    learner: &[f32],
    mean: &[f32],
    parameters: &[f32],
    action: &mut [f32],
    params: &Params,
) {
    let width = params.action as usize;
    let rows = own.iter().zip(place).take(params.envs as usize);
    for (env, (&row, &place)) in rows.enumerate() {
        let learner = &learner[params.at as usize + env * width..][..width];
        action[row as usize * width..][..width].copy_from_slice(learner);
        if place >= SCRIPTED {
            continue;
        }
        let policy = (blocks[(place / params.block) as usize] * params.parameters) as usize;
        let log_std = &parameters[policy + params.log_std as usize..][..width];
        let mean = &mean[place as usize * width..][..width];
        let action = &mut action[(row ^ 1) as usize * width..][..width];
        for (i, (action, (mean, log_std))) in
            action.iter_mut().zip(mean.iter().zip(log_std)).enumerate()
        {
            let number = params.first + env as u32;
            let noise = noise(params.seed, number, params.step_counter, i);
            *action = mean + log_std.exp() * noise;
        }
    }
}
