//! What opponents observe. Shader: `shaders/self_play/opponent_input.wgsl`.

use super::NOBODY;
use crate::gpu::{Argument, Buffer, Gpu, shader};

crate::shader_params! {
    pub struct Params for opponent_input {
        /// Rows of policies.
        pub slots: u32,
        /// Numbers of an observation.
        pub observation: u32,
        /// Rows of a block.
        pub block: u32,
        /// Largest magnitude of a normalised number.
        pub clip: f32,
    }
}

/// Queues the shader on `gpu`.
///
/// `slots` and `blocks` are those of [`group_bouts`](super::group_bouts), `own` is the learner's row in each
/// environment, whose other one is the opponent's, and `observation` holds `[2 envs][observation]`. `scale` is
/// `[policies][2][observation]`: what is subtracted from every number, and then multiplied by. `input` takes
/// `[slots][observation]`; rows of nobody are left as they are.
pub fn launch(
    gpu: &Gpu,
    slots: &Buffer<u32>,
    blocks: &Buffer<u32>,
    own: &Buffer<u32>,
    observation: &Buffer<f32>,
    scale: &Buffer<f32>,
    input: &Buffer<f32>,
    params: &Params,
) {
    let [across, down, _] = shader::OPPONENT_INPUT.workgroup;
    let groups = [
        params.observation.div_ceil(across),
        params.slots.div_ceil(down),
        1,
    ];
    let buffers: [&dyn Argument; 6] = [slots, blocks, own, observation, scale, input];
    gpu.launch(&shader::OPPONENT_INPUT, groups, &buffers, params);
}

/// The shader's computation on the host.
pub fn twin(
    slots: &[u32],
    blocks: &[u32],
    own: &[u32],
    observation: &[f32],
    scale: &[f32],
    input: &mut [f32],
    params: &Params,
) {
    let (width, clip) = (params.observation as usize, params.clip);
    let rows = slots.iter().zip(input.chunks_exact_mut(width));
    for (slot, (&env, input)) in rows.take(params.slots as usize).enumerate() {
        if env == NOBODY {
            continue;
        }
        let row = (own[env as usize] ^ 1) as usize;
        let policy = blocks[slot / params.block as usize] as usize;
        let (means, factors) = scale[2 * policy * width..][..2 * width].split_at(width);
        let numbers = observation[row * width..][..width].iter();
        let scales = means.iter().zip(factors);
        for (input, (number, (mean, factor))) in input.iter_mut().zip(numbers.zip(scales)) {
            *input = ((number - mean) * factor).clamp(-clip, clip);
        }
    }
}
