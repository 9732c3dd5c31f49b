// One step of Adam (Kingma and Ba 2015, algorithm 1) against a gradient whose norm is clipped first. One
// invocation a parameter.
//
// gradient       [parameters]
// norm_partials  [NORM_PARTIALS]   parts of the square of its norm
// parameters     [parameters]
// m              [parameters]      running mean of the gradient
// v              [parameters]      and of its square
// rates          [2]               factors of the learning rate, the second of the parameters from `second`
//                                  up to `second_end`

#import adam

struct Params {
    parameters: u32,
    // Learning rate over 1 - beta_1^steps, and 1 / (1 - beta_2^steps).
    lr: f32,
    bias_correction: f32,
    // Largest norm of the gradient; 0 for no limit.
    max_grad_norm: f32,
    second: u32,
    second_end: u32,
}

@group(0) @binding(0) var<storage, read> gradient: array<f32>;
@group(0) @binding(1) var<storage, read> norm_partials: array<f32>;
@group(0) @binding(2) var<storage, read_write> parameters: array<f32>;
@group(0) @binding(3) var<storage, read_write> m: array<f32>;
@group(0) @binding(4) var<storage, read_write> v: array<f32>;
@group(0) @binding(5) var<storage, read> rates: array<f32>;
@group(0) @binding(6) var<uniform> params: Params;

const BETA_1 = 0.9;
const BETA_2 = 0.999;
const EPSILON = 1e-5;

@compute @workgroup_size(64)
fn adam(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + id.y * groups.x * 64u;
    if (i >= params.parameters) { return; }
    var square = 0.0;
    for (var part = 0u; part < NORM_PARTIALS; part++) { square += norm_partials[part]; }
    let limit = params.max_grad_norm;
    let clip_scale = select(1.0, min(1.0, limit / (sqrt(square) + 1e-6)), limit > 0.0);
    let grad = gradient[i] * clip_scale;
    let mean = BETA_1 * m[i] + (1.0 - BETA_1) * grad;
    let mean_square = BETA_2 * v[i] + (1.0 - BETA_2) * grad * grad;
    m[i] = mean;
    v[i] = mean_square;
    let factor = rates[select(0u, 1u, i >= params.second && i < params.second_end)];
    parameters[i] -= params.lr * factor * mean / (sqrt(mean_square * params.bias_correction) + EPSILON);
}
