//! What a discriminator sees of a rollout. Shader: `shaders/learn/style_windows.wgsl`.

use crate::gpu::{Buffer, Gpu, groups, shader};
use crate::kernels::termination::RUNNING;

crate::shader_params! {
    pub struct Params for style_windows {
        /// Length of the rollout.
        pub steps: u32,
        /// Rows of the rollout: agents that act side by side.
        pub rows: u32,
        /// Numbers of an observation.
        pub observation: u32,
        /// Those of them that say how the agent moves; they come first.
        pub style: u32,
        /// Steps of `final_observation`: 1 if no row ends twice in the rollout.
        pub final_steps: u32,
    }
}

/// No body that has not diverged observes more than this. What has diverged counts as not having moved.
const MOST: f32 = 1024.0;

/// Queues the shader on `gpu`.
///
/// `observation` is `[steps][rows][observation]`, `next_observation` `[rows][observation]`,
/// `final_observation` `[final_steps][rows][observation]`, `termination` `[steps][rows]`; `windows` takes
/// `[steps][rows][2 style]`: the moments before and after each step, of the first numbers of observations. Of an agent that has diverged both are
/// the moment before.
pub fn launch(
    gpu: &Gpu,
    observation: &Buffer<f32>,
    next_observation: &Buffer<f32>,
    final_observation: &Buffer<f32>,
    termination: &Buffer<u32>,
    windows: &Buffer<f32>,
    params: &Params,
) {
    let samples = (params.steps * params.rows) as usize;
    gpu.launch(
        &shader::STYLE_WINDOWS,
        groups(&shader::STYLE_WINDOWS, samples),
        &[
            observation,
            next_observation,
            final_observation,
            termination,
            windows,
        ],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(
    observation: &[f32],
    next_observation: &[f32],
    final_observation: &[f32],
    termination: &[u32],
    windows: &mut [f32],
    params: &Params,
) {
    let rows = params.rows as usize;
    let samples = rows * params.steps as usize;
    let style = params.style as usize;
    let moment = |of: &[f32], row: usize| -> Vec<f32> {
        of[row * params.observation as usize..][..style].to_vec()
    };
    let windows = windows.chunks_exact_mut(2 * style).enumerate();
    for (sample, window) in windows.take(samples) {
        let row = sample % rows;
        let before = moment(observation, sample);
        let after = if termination[sample] != RUNNING {
            let one = params.final_steps == 1;
            moment(final_observation, if one { row } else { sample })
        } else if sample + rows >= samples {
            moment(next_observation, row)
        } else {
            moment(observation, sample + rows)
        };
        let diverged = !after.iter().all(|value| value.abs() <= MOST);
        let (first, second) = window.split_at_mut(style);
        first.copy_from_slice(&before);
        second.copy_from_slice(if diverged { &before } else { &after });
    }
}
