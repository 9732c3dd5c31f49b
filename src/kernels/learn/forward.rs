//! Answers of one or both networks to samples. Shader: `shaders/learn/forward.wgsl`.

use crate::kernels::locomotion::locomotion_layout::BASE_OBS_DIM;
use super::network::{BLOCK, Plan};
use crate::gpu::{Buffer, Gpu, shader};

crate::shader_params! {
    pub struct Params for forward {
        pub rows: u32,
        /// The first sample.
        pub start: u32,
        /// Numbers of a sample, observations first.
        pub width: u32,
        /// 0: the actor, or both. 1: the critic.
        pub first: u32,
    }
}

/// `networks`: how many answer, one after the other into `answers`.
pub fn launch(
    gpu: &Gpu,
    networks: u32,
    plan: &Buffer<u32>,
    samples: &Buffer<f32>,
    parameters: &Buffer<f32>,
    rows: &Buffer<f32>,
    answers: &Buffer<f32>,
    params: &Params,
) {
    let groups = [params.rows.div_ceil(BLOCK as u32), 1, networks];
    let buffers: [&dyn crate::gpu::buffer::Argument; 5] =
        [plan, samples, parameters, rows, answers];
    gpu.launch(&shader::FORWARD, groups, &buffers, params);
}

pub fn twin(
    networks: u32,
    plan: &Plan,
    samples: &[f32],
    parameters: &[f32],
    rows: &mut [f32],
    answers: &mut [f32],
    params: &Params,
) {
    let [count, start, width, first] =
        [params.rows, params.start, params.width, params.first].map(|n| n as usize);
    let filled = count.next_multiple_of(BLOCK);
    let mut answered = 0;
    for network in first..first + networks as usize {
        let observed = plan.places[network].below as usize;
        for row in 0..filled {
            for column in 0..BASE_OBS_DIM {
                let sample = row < count;
                let from = (start + row) * width + column;
                rows[plan.at(row, observed + column)] = if sample { samples[from] } else { 0.0 };
            }
        }
        for place in plan.layers(network) {
            let [inputs, outputs, weights, below, above] = place.sizes();
            let (weights, biases) = parameters[weights..].split_at(inputs * outputs);
            for row in 0..filled {
                for output in 0..outputs {
                    let weights = weights[output..].iter().step_by(outputs);
                    let terms = (0..inputs).zip(weights);
                    let sum = terms.fold(biases[output], |sum, (input, weight)| {
                        sum + rows[plan.at(row, below + input)] * weight
                    });
                    if place.bent == 1 {
                        rows[plan.at(row, above + output)] = sum.tanh();
                    } else if row < count {
                        answers[answered + row * outputs + output] = sum;
                    }
                }
            }
            if place.bent == 0 {
                answered += count * outputs;
            }
        }
    }
}
