//! The gradient with respect to all parameters over each piece of a minibatch. Shader:
//! `shaders/learn/gradient.wgsl`.

use super::network::{BLOCK, LANES, Place, Plan, SUMS};
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
        most(|place| place.outputs).div_ceil(LANES),
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
    let (piece, all) = (plan.head.piece as usize * BLOCK, plan.blocks() * BLOCK);
    let numbers = params.parameters as usize + SUMS;
    for (at, partial) in partials.chunks_exact_mut(numbers).enumerate() {
        for place in &plan.places {
            let [inputs, outputs, weights, below, above] = place.sizes();
            let sums = &mut partial[weights..][..(inputs + 1) * outputs];
            sums.fill(0.0);
            for row in at * piece..all.min((at + 1) * piece) {
                // A bias is the weight of an input that is always one.
                let inputs = (0..inputs).map(|input| rows[plan.at(row, below + input)]);
                for (input, sums) in inputs.chain([1.0]).zip(sums.chunks_exact_mut(outputs)) {
                    for (output, sum) in sums.iter_mut().enumerate() {
                        *sum += input * slopes[plan.at(row, above + output)];
                    }
                }
            }
        }
    }
}
