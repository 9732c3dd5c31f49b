//! One layer of one or both networks. Shader: `shaders/learn/forward.wgsl`.

use super::network::Plan;
use crate::gpu::{Buffer, Gpu, shader};

crate::shader_params! {
    pub struct Params for forward {
        /// The places computed: `first` and, with `count` 2, the next.
        pub first: u32,
        pub count: u32,
    }
}

/// Workgroups of a launch.
pub fn groups(plan: &Plan, params: &Params) -> [u32; 3] {
    let places = &plan.places[params.first as usize..][..params.count as usize];
    plan.groups(places, |place| place.outputs)
}

pub fn launch(
    gpu: &Gpu,
    plan: (&Plan, &Buffer<u32>),
    parameters: &Buffer<f32>,
    rows: &Buffer<f32>,
    params: &Params,
) {
    let (plan, table) = plan;
    let groups = groups(plan, params);
    gpu.launch(&shader::FORWARD, groups, &[table, parameters, rows], params);
}

pub fn twin(plan: &Plan, parameters: &[f32], rows: &mut [f32], params: &Params) {
    let pitch = plan.head.pitch as usize;
    for place in &plan.places[params.first as usize..][..params.count as usize] {
        let [inputs, outputs, weights, below, above] = place.sizes();
        let (weights, rest) = parameters[weights..].split_at(inputs * outputs);
        for row in rows.chunks_exact_mut(pitch).take(plan.head.rows as usize) {
            for output in 0..outputs {
                let weights = weights[output..].iter().step_by(outputs);
                let terms = row[below..][..inputs].iter().zip(weights);
                let sum = terms.fold(rest[output], |sum, (x, weight)| sum + x * weight);
                row[above + output] = if place.bent == 1 { sum.tanh() } else { sum };
            }
        }
    }
}
