//! Final observations of a high level's decision. Shader: `shaders/learn/keep_first_end.wgsl`.

use crate::gpu::{Buffer, Gpu, groups, shader};
use crate::kernels::termination::RUNNING;

crate::shader_params! {
    pub struct Params for keep_first_end {
        /// Rows of the batch.
        pub rows: u32,
        /// Numbers of an observation.
        pub observation: u32,
        /// Index of the decision's first termination.
        pub at: u32,
        /// Index of the decision's first final observation.
        pub final_at: u32,
        /// Step of the decision, from 0.
        pub step: u32,
    }
}

/// Queues the shader on `gpu`.
///
/// `termination` is `[rows]` of a step of a low level, `decision_termination` that of the decision before it,
/// from `params.at` on, which is not read in the decision's first step. `last` is `[rows][observation]`: its
/// rows whose step ended an episode, the first of the decision, go to `final_observation`, from
/// `params.final_at` on; others are left as they are.
pub fn launch(
    gpu: &Gpu,
    termination: &Buffer<u32>,
    decision_termination: &Buffer<u32>,
    last: &Buffer<f32>,
    final_observation: &Buffer<f32>,
    params: &Params,
) {
    let [across, ..] = groups(&shader::KEEP_FIRST_END, params.rows as usize);
    let buffers: [&dyn crate::gpu::Argument; 4] =
        [termination, decision_termination, last, final_observation];
    let groups = [across, params.observation, 1];
    gpu.launch(&shader::KEEP_FIRST_END, groups, &buffers, params);
}

/// The shader's computation on the host.
pub fn twin(
    termination: &[u32],
    decision_termination: &[u32],
    last: &[f32],
    final_observation: &mut [f32],
    params: &Params,
) {
    let width = params.observation as usize;
    let first_end = |row: usize| {
        let ended_before = || decision_termination[params.at as usize + row] != RUNNING;
        termination[row] != RUNNING && (params.step == 0 || !ended_before())
    };
    for row in (0..params.rows as usize).filter(|&row| first_end(row)) {
        let to = &mut final_observation[params.final_at as usize + row * width..][..width];
        to.copy_from_slice(&last[row * width..][..width]);
    }
}
