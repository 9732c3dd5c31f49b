// The diversity loss of every row and its gradient: two latents are to lead to actions as far apart as they
// are. One invocation a row; adds to the gradients that ppo_loss has written.
//
// dims          [4]            numbers of an observation; where log_std begins; numbers of an action; values
// samples       [..][width]    .., then the mean action [action] under another latent, the agent's own latent
//                              [latent], and that other one [latent]
// outputs       [rows][action] mean, then those of other networks
// output_grads  of the same form

struct Params {
    rows: u32,
    // The first sample.
    start: u32,
    // Numbers of a sample.
    width: u32,
    latent: u32,
    // Weight of a row.
    weight: f32,
}

@group(0) @binding(0) var<storage, read> dims: array<u32>;
@group(0) @binding(1) var<storage, read> samples: array<f32>;
@group(0) @binding(2) var<storage, read> outputs: array<f32>;
@group(0) @binding(3) var<storage, read_write> output_grads: array<f32>;
@group(0) @binding(4) var<uniform> params: Params;

// Keeps latents that are the same from asking for nothing over nothing.
const LEAST = 1e-5;

@compute @workgroup_size(64)
fn diversity_loss(@builtin(global_invocation_id) id: vec3u) {
    let row = id.x;
    if (row >= params.rows) { return; }
    let actions = dims[2];
    let sample = (params.start + row) * params.width;
    let other = sample + params.width - params.latent;
    let own = other - params.latent;
    let other_mean = own - actions;
    var squares = vec2f(0.0);
    var product = 0.0;
    for (var i = 0u; i < params.latent; i++) {
        let pair = vec2f(samples[own + i], samples[other + i]);
        squares += pair * pair;
        product += pair.x * pair.y;
    }
    let lengths = max(sqrt(squares.x * squares.y), 1e-6);
    let apart = 0.5 - 0.5 * product / lengths + LEAST;
    var difference = 0.0;
    for (var i = 0u; i < actions; i++) {
        let change = outputs[row * actions + i] - samples[other_mean + i];
        difference += change * change / f32(actions);
    }
    let missing = 1.0 - difference / apart;
    let slope = -8.0 * params.weight * missing / (apart * f32(actions));
    for (var i = 0u; i < actions; i++) {
        let change = outputs[row * actions + i] - samples[other_mean + i];
        output_grads[row * actions + i] += slope * change;
    }
}
