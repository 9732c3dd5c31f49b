//! Normalises the advantages of a rollout, those of each group apart. Shader:
//! `shaders/learn/normalize_advantages.wgsl`.

use super::rollout_moments::scale;
use crate::gpu::{Buffer, Gpu, shader};

crate::shader_params! {
    pub struct Params for normalize_advantages {
        /// Samples of the rollout.
        pub samples: u32,
        /// Streams of rewards.
        pub streams: u32,
    }
}

/// Least standard deviation of the advantages.
const MIN_STD: f32 = 1e-6;

/// Workgroups for so many numbers, in two dimensions where one does not suffice.
pub fn groups(numbers: usize) -> [u32; 3] {
    const MOST: u32 = 1 << 15;
    let groups = (numbers as u32).div_ceil(shader::NORMALIZE_ADVANTAGES.workgroup[0]);
    [groups.min(MOST), groups.div_ceil(MOST), 1]
}

/// Queues the shader on `gpu`.
///
/// `group` is `[samples]`, `scale` `[streams][FIELDS]` as
/// [`rollout_moments`](super::rollout_moments) leaves it, `advantage_and_return` `[2][samples][streams]`,
/// of which the advantages are normalised and weighed.
pub fn launch(
    gpu: &Gpu,
    group: &Buffer<u32>,
    scale: &Buffer<f32>,
    advantage_and_return: &Buffer<f32>,
    params: &Params,
) {
    let groups = groups((params.samples * params.streams) as usize);
    gpu.launch(
        &shader::NORMALIZE_ADVANTAGES,
        groups,
        &[group, scale, advantage_and_return],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(group: &[u32], scale: &[f32], advantage_and_return: &mut [f32], params: &Params) {
    let rows = advantage_and_return.chunks_exact_mut(params.streams as usize);
    for (row, &kind) in rows.zip(group).take(params.samples as usize) {
        for (advantage, scale) in row.iter_mut().zip(scale.chunks_exact(scale::FIELDS)) {
            let kind = kind as usize;
            let centered = *advantage - scale[scale::ADVANTAGE_MEAN + kind];
            *advantage =
                scale[scale::WEIGHT] * centered / (scale[scale::ADVANTAGE_STD + kind] + MIN_STD);
        }
    }
}
