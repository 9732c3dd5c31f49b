//! One step of Adam. Shader: `shaders/learn/adam.wgsl`.

use crate::gpu::{Argument, Buffer, Gpu, shader};
use multiversion::multiversion;

crate::shader_params! {
    pub struct Params for adam {
        /// Number of parameters.
        pub parameters: u32,
        /// Learning rate over `1 - beta_1^steps`.
        pub lr: f32,
        /// `1 / (1 - beta_2^steps)`.
        pub bias_correction: f32,
        /// Largest norm of the gradient; 0 for no limit.
        pub max_grad_norm: f32,
    }
}

/// Decay of the gradient's running mean, as Kingma and Ba have it.
pub const BETA_1: f64 = 0.9;
/// Decay of the running mean of its square, as Kingma and Ba have it.
pub const BETA_2: f64 = 0.999;
const EPSILON: f32 = 1e-5;

impl Params {
    /// Parameters of the `steps`-th step, whose moments are corrected for having begun at zero.
    pub fn new(parameters: usize, steps: u64, lr: f64, max_grad_norm: f64) -> Self {
        let steps = steps.min(i32::MAX as u64) as i32;
        Params {
            parameters: parameters as u32,
            lr: (lr / (1.0 - BETA_1.powi(steps))) as f32,
            bias_correction: (1.0 / (1.0 - BETA_2.powi(steps))) as f32,
            max_grad_norm: max_grad_norm as f32,
        }
    }
}

/// Workgroups for so many parameters, in two dimensions where one does not suffice.
pub fn groups(parameters: usize) -> [u32; 3] {
    const MOST: u32 = 1 << 15;
    let groups = (parameters as u32).div_ceil(shader::ADAM.workgroup[0]);
    [groups.min(MOST), groups.div_ceil(MOST), 1]
}

/// Queues the shader on `gpu`.
///
/// `gradient`, `parameters`, `m` and `v` are `[parameters]`: `m` and `v` are the running means of
/// the gradient and of its square. `norm_partials` is `[NORM_PARTIALS]`, see
/// [`grad_norm`](super::grad_norm).
pub fn launch(
    gpu: &Gpu,
    gradient: &Buffer<f32>,
    norm_partials: &Buffer<f32>,
    parameters: &Buffer<f32>,
    m: &Buffer<f32>,
    v: &Buffer<f32>,
    params: &Params,
) {
    let buffers: [&dyn Argument; 5] = [gradient, norm_partials, parameters, m, v];
    gpu.launch(
        &shader::ADAM,
        groups(params.parameters as usize),
        &buffers,
        params,
    );
}

/// The shader's computation on the host.
#[multiversion(targets("x86_64+avx512f+avx512vl+fma", "x86_64+avx2+fma", "aarch64+neon"))]
pub fn twin(
    gradient: &[f32],
    norm_partials: &[f32],
    parameters: &mut [f32],
    m: &mut [f32],
    v: &mut [f32],
    params: &Params,
) {
    let norm = norm_partials.iter().sum::<f32>().sqrt();
    let clip_scale = match params.max_grad_norm > 0.0 {
        true => (params.max_grad_norm / (norm + 1e-6)).min(1.0),
        false => 1.0,
    };
    let [keep_m, keep_v] = [BETA_1, BETA_2].map(|beta| beta as f32);
    let [take_m, take_v] = [BETA_1, BETA_2].map(|beta| (1.0 - beta) as f32);
    let moments = m.iter_mut().zip(v);
    for ((parameter, gradient), (m, v)) in parameters.iter_mut().zip(gradient).zip(moments) {
        let gradient = gradient * clip_scale;
        *m = keep_m * *m + take_m * gradient;
        *v = keep_v * *v + take_v * gradient * gradient;
        *parameter -= params.lr * *m / ((*v * params.bias_correction).sqrt() + EPSILON);
    }
}
