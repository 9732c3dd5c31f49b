//! One step of Adam. Shader: `shaders/learn/adam.wgsl`.

use crate::gpu::{Argument, Buffer, Gpu, shader};
use multiversion::multiversion;
use std::ops::Range;

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
        /// The first parameter whose learning rate has the second factor.
        pub second: u32,
        /// The first behind them that has the first factor again.
        pub second_end: u32,
    }
}

/// Decay of the gradient's running mean, as Kingma and Ba have it.
pub const BETA_1: f64 = 0.9;
/// Decay of the running mean of its square, as Kingma and Ba have it.
pub const BETA_2: f64 = 0.999;
const EPSILON: f32 = 1e-5;

impl Params {
    /// Parameters of the `steps`-th step, whose moments are corrected for having begun at zero.
    /// Those of `second` have the second factor of the learning rate.
    pub fn new(
        parameters: usize,
        steps: u64,
        lr: f64,
        max_grad_norm: f64,
        second: Range<usize>,
    ) -> Self {
        let steps = steps.min(i32::MAX as u64) as i32;
        Params {
            parameters: parameters as u32,
            lr: (lr / (1.0 - BETA_1.powi(steps))) as f32,
            bias_correction: (1.0 / (1.0 - BETA_2.powi(steps))) as f32,
            max_grad_norm: max_grad_norm as f32,
            second: second.start as u32,
            second_end: second.end as u32,
        }
    }
}

impl Params {
    /// Those of so many parameters from `first` on, as if they were all.
    pub fn of_strip(self, first: usize, len: usize) -> Self {
        let within = |at: u32| (at as usize).saturating_sub(first).min(len) as u32;
        Params {
            parameters: len as u32,
            second: within(self.second),
            second_end: within(self.second_end),
            ..self
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
/// [`grad_norm`](super::grad_norm). `rates` are two factors of the learning rate.
pub fn launch(
    gpu: &Gpu,
    gradient: &Buffer<f32>,
    norm_partials: &Buffer<f32>,
    parameters: &Buffer<f32>,
    m: &Buffer<f32>,
    v: &Buffer<f32>,
    rates: &Buffer<f32>,
    params: &Params,
) {
    let buffers: [&dyn Argument; 6] = [gradient, norm_partials, parameters, m, v, rates];
    gpu.launch(
        &shader::ADAM,
        groups(params.parameters as usize),
        &buffers,
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(
    gradient: &[f32],
    norm_partials: &[f32],
    parameters: &mut [f32],
    m: &mut [f32],
    v: &mut [f32],
    rates: &[f32],
    params: &Params,
) {
    let end = params.parameters as usize;
    let [second, second_end] = [params.second, params.second_end].map(|at| (at as usize).min(end));
    let parts = [(0..second, 0), (second..second_end.max(second), 1)];
    let rest = (second_end.max(second)..end, 0);
    for (part, rate) in parts.into_iter().chain([rest]) {
        step(
            &gradient[part.clone()],
            norm_partials,
            &mut parameters[part.clone()],
            &mut m[part.clone()],
            &mut v[part],
            rates[rate],
            params,
        );
    }
}

/// A step of parameters whose learning rate has one factor.
#[multiversion(targets("x86_64+avx512f+avx512vl+fma", "x86_64+avx2+fma", "aarch64+neon"))]
pub fn step(
    gradient: &[f32],
    norm_partials: &[f32],
    parameters: &mut [f32],
    m: &mut [f32],
    v: &mut [f32],
    factor: f32,
    params: &Params,
) {
    let lr = params.lr * factor;
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
        *parameter -= lr * *m / ((*v * params.bias_correction).sqrt() + EPSILON);
    }
}
