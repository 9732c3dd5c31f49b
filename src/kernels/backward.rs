//! The gradient with respect to what comes into a layer. Shader: `shaders/learn/backward.wgsl`.

use super::network::Plan;
use crate::gpu::{Buffer, Gpu, shader};

crate::shader_params! {
    pub struct Params for backward {
        /// The actor's place; the critic's is the next.
        pub first: u32,
    }
}

/// Workgroups of a launch.
pub fn groups(plan: &Plan, params: &Params) -> [u32; 3] {
    let places = &plan.places[params.first as usize..][..2];
    plan.groups(places, |place| place.inputs)
}

pub fn launch(
    gpu: &Gpu,
    plan: (&Plan, &Buffer<u32>),
    turned: &Buffer<f32>,
    rows: &Buffer<f32>,
    slopes: &Buffer<f32>,
    params: &Params,
) {
    let (plan, table) = plan;
    let groups = groups(plan, params);
    let buffers: [&dyn crate::gpu::buffer::Argument; 4] = [table, turned, rows, slopes];
    gpu.launch(&shader::BACKWARD, groups, &buffers, params);
}

pub fn twin(plan: &Plan, turned: &[f32], rows: &[f32], slopes: &mut [f32], params: &Params) {
    let pitch = plan.head.pitch as usize;
    for place in &plan.places[params.first as usize..][..2] {
        let [inputs, outputs, weights, below, above] = place.sizes();
        let rows = rows.chunks_exact(pitch).take(plan.head.rows as usize);
        for (row, slopes) in rows.zip(slopes.chunks_exact_mut(pitch)) {
            for input in 0..inputs {
                let weights = turned[weights + input..].iter().step_by(inputs);
                let terms = slopes[above..][..outputs].iter().zip(weights);
                let sum: f32 = terms.map(|(slope, weight)| slope * weight).sum();
                let bent = row[below + input];
                slopes[below + input] = sum * (1.0 - bent * bent);
            }
        }
    }
}
