//! The gradient with respect to all parameters over each piece of a minibatch. Shader:
//! `shaders/learn/gradient.wgsl`.

use super::network::{BLOCK, Place, Plan, SUMS};
use crate::gpu::{Buffer, Gpu, shader};

crate::shader_params! {
    pub struct Params for gradient {
        pub parameters: u32,
    }
}

/// Workgroups of a launch.
pub fn groups(plan: &Plan) -> [u32; 3] {
    let most = |of: fn(&Place) -> u32| plan.places.iter().map(of).max().unwrap_or(0);
    [
        most(|place| place.outputs).div_ceil(32),
        most(|place| place.inputs).div_ceil(BLOCK as u32) + 1,
        plan.head.pieces * plan.head.count,
    ]
}

pub fn launch(
    gpu: &Gpu,
    plan: (&Plan, &Buffer<u32>),
    rows: &Buffer<f32>,
    slopes: &Buffer<f32>,
    partials: &Buffer<f32>,
    params: &Params,
) {
    let (plan, table) = plan;
    let groups = groups(plan);
    let buffers: [&dyn crate::gpu::buffer::Argument; 4] = [table, rows, slopes, partials];
    gpu.launch(&shader::GRADIENT, groups, &buffers, params);
}

pub fn twin(plan: &Plan, rows: &[f32], slopes: &[f32], partials: &mut [f32], params: &Params) {
    let [pitch, piece, all] =
        [plan.head.pitch, plan.head.piece, plan.head.rows].map(|n| n as usize);
    let numbers = params.parameters as usize + SUMS;
    let pieces = rows[..all * pitch]
        .chunks(piece * pitch)
        .zip(slopes.chunks(piece * pitch));
    for ((rows, slopes), partial) in pieces.zip(partials.chunks_exact_mut(numbers)) {
        for place in &plan.places {
            let [inputs, outputs, weights, below, above] = place.sizes();
            let sums = &mut partial[weights..][..(inputs + 1) * outputs];
            sums.fill(0.0);
            for (row, slopes) in rows.chunks_exact(pitch).zip(slopes.chunks_exact(pitch)) {
                // A bias is the weight of an input that is always one.
                let inputs = row[below..][..inputs].iter().chain(&[1.0]);
                for (input, sums) in inputs.zip(sums.chunks_exact_mut(outputs)) {
                    for (sum, slope) in sums.iter_mut().zip(&slopes[above..]) {
                        *sum += input * slope;
                    }
                }
            }
        }
    }
}
