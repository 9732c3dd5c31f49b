//! Begins the rows of a minibatch. Shader: `shaders/learn/take.wgsl`.

use super::layout::GOAL;
use super::network::Plan;
use crate::gpu::kernel::groups;
use crate::gpu::{Buffer, Gpu, shader};

crate::shader_params! {
    pub struct Params for take {
        pub rows: u32,
        /// The minibatch's first sample.
        pub start: u32,
        /// Numbers of a sample.
        pub width: u32,
    }
}

pub fn launch(
    gpu: &Gpu,
    plan: &Buffer<u32>,
    samples: &Buffer<f32>,
    rows: &Buffer<f32>,
    params: &Params,
) {
    let groups = groups(&shader::TAKE, params.rows as usize * GOAL);
    gpu.launch(&shader::TAKE, groups, &[plan, samples, rows], params);
}

pub fn twin(plan: &Plan, samples: &[f32], rows: &mut [f32], params: &Params) {
    let (width, pitch) = (params.width as usize, plan.head.pitch as usize);
    let samples = samples.chunks_exact(width).skip(params.start as usize);
    let rows = rows.chunks_exact_mut(pitch).take(params.rows as usize);
    for (row, sample) in rows.zip(samples) {
        row[..GOAL].copy_from_slice(&sample[..GOAL]);
    }
}
