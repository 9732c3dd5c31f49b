// One step of Adam (Kingma and Ba 2015, algorithm 1) against a gradient whose norm is first cut. One
// invocation a parameter.
//
// plan        see network
// gradient    [parameters]
// squares     [workgroups of `total`]   those of the gradient, added up
// place       [parameters]   of each parameter in `turned`
// parameters  [parameters]
// turned      [parameters]   weights as [outputs][inputs]
// first       [parameters]   running means of the gradient
// second      [parameters]   and of its square

#import network

struct Params {
    parameters: u32,
    // Learning rate over 1 - beta_1^steps, and 1 / (1 - beta_2^steps).
    rate: f32,
    unbias: f32,
    // Largest norm of the gradient; 0 for no limit.
    max_norm: f32,
}

@group(0) @binding(0) var<storage, read> plan: Plan;
@group(0) @binding(1) var<storage, read> gradient: array<f32>;
@group(0) @binding(2) var<storage, read> squares: array<f32>;
@group(0) @binding(3) var<storage, read> place: array<u32>;
@group(0) @binding(4) var<storage, read_write> parameters: array<f32>;
@group(0) @binding(5) var<storage, read_write> turned: array<f32>;
@group(0) @binding(6) var<storage, read_write> first: array<f32>;
@group(0) @binding(7) var<storage, read_write> second: array<f32>;
@group(0) @binding(8) var<uniform> params: Params;

const BETA_1 = 0.9;
const BETA_2 = 0.999;
const EPSILON = 1e-5;

@compute @workgroup_size(64)
fn adam(@builtin(global_invocation_id) id: vec3u) {
    let i = id.x;
    if (i >= params.parameters) { return; }
    var square = 0.0;
    let groups = (plan.parameters + SUMS + GROUP - 1u) / GROUP;
    for (var group = 0u; group < groups; group++) { square += squares[group]; }
    let cut = select(1.0, min(1.0, params.max_norm / (sqrt(square) + 1e-6)), params.max_norm > 0.0);
    let slope = gradient[i] * cut;
    let mean = BETA_1 * first[i] + (1.0 - BETA_1) * slope;
    let spread = BETA_2 * second[i] + (1.0 - BETA_2) * slope * slope;
    let moved = parameters[i] - params.rate * mean / (sqrt(spread * params.unbias) + EPSILON);
    first[i] = mean;
    second[i] = spread;
    parameters[i] = moved;
    turned[place[i]] = moved;
}
