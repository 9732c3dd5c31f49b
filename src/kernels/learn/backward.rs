//! The gradient with respect to what comes into the layers. Shader: `shaders/learn/backward.wgsl`.

use super::network::{BLOCK, Plan};
use crate::gpu::{Buffer, Gpu, shader};

crate::shader_params! {
    pub struct Params for backward {
        pub rows: u32,
    }
}

pub fn launch(
    gpu: &Gpu,
    plan: &Buffer<u32>,
    turned: &Buffer<f32>,
    rows: &Buffer<f32>,
    slopes: &Buffer<f32>,
    params: &Params,
) {
    let groups = [params.rows.div_ceil(BLOCK as u32), 1, 2];
    gpu.launch(
        &shader::BACKWARD,
        groups,
        &[plan, turned, rows, slopes],
        params,
    );
}

pub fn twin(plan: &Plan, turned: &[f32], rows: &[f32], slopes: &mut [f32], params: &Params) {
    for network in [0, 1] {
        // What is observed does not learn.
        for place in plan.layers(network).skip(1).rev() {
            let [inputs, outputs, weights, below, above] = place.sizes();
            for row in 0..(params.rows as usize).next_multiple_of(BLOCK) {
                for input in 0..inputs {
                    let weights = turned[weights + input..].iter().step_by(inputs);
                    let terms = (0..outputs).zip(weights);
                    let terms = terms.map(|(o, weight)| slopes[plan.at(row, above + o)] * weight);
                    let sum: f32 = terms.sum();
                    let bent = rows[plan.at(row, below + input)];
                    slopes[plan.at(row, below + input)] = sum * (1.0 - bent * bent);
                }
            }
        }
    }
}
