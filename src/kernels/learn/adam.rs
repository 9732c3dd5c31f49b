//! One step of Adam. Shader: `shaders/learn/adam.wgsl`.

use super::network::Plan;
use crate::gpu::kernel::groups;
use crate::gpu::{Buffer, Gpu, shader};

crate::shader_params! {
    pub struct Params for adam {
        pub parameters: u32,
        /// Learning rate over `1 - beta_1^steps`.
        pub rate: f32,
        /// `1 / (1 - beta_2^steps)`.
        pub unbias: f32,
        /// Largest norm of the gradient; 0 for no limit.
        pub max_norm: f32,
    }
}

/// Kingma and Ba's, but for the last.
pub const BETA_1: f64 = 0.9;
pub const BETA_2: f64 = 0.999;
pub const EPSILON: f64 = 1e-5;

pub fn launch(
    gpu: &Gpu,
    plan: &Buffer<u32>,
    gradient: &Buffer<f32>,
    squares: &Buffer<f32>,
    place: &Buffer<u32>,
    parameters: &Buffer<f32>,
    turned: &Buffer<f32>,
    first: &Buffer<f32>,
    second: &Buffer<f32>,
    params: &Params,
) {
    let groups = groups(&shader::ADAM, params.parameters as usize);
    let buffers: [&dyn crate::gpu::buffer::Argument; 8] = [
        plan, gradient, squares, place, parameters, turned, first, second,
    ];
    gpu.launch(&shader::ADAM, groups, &buffers, params);
}

pub fn twin(
    _plan: &Plan,
    gradient: &[f32],
    squares: &[f32],
    place: &[u32],
    parameters: &mut [f32],
    turned: &mut [f32],
    first: &mut [f32],
    second: &mut [f32],
    params: &Params,
) {
    let norm = squares.iter().sum::<f32>().sqrt();
    let cut = match params.max_norm > 0.0 {
        true => (params.max_norm / (norm + 1e-6)).min(1.0),
        false => 1.0,
    };
    let [keep_1, keep_2, epsilon] = [BETA_1, BETA_2, EPSILON].map(|constant| constant as f32);
    for i in 0..params.parameters as usize {
        let slope = gradient[i] * cut;
        first[i] = keep_1 * first[i] + (1.0 - keep_1) * slope;
        second[i] = keep_2 * second[i] + (1.0 - keep_2) * slope * slope;
        parameters[i] -= params.rate * first[i] / ((second[i] * params.unbias).sqrt() + epsilon);
        turned[place[i] as usize] = parameters[i];
    }
}
