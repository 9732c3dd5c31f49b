// Draws actions from the policy's Gaussian. One invocation a row.
//
// mean      [..][action]   of the policy
// log_std   [action]
// action    [..][action]
// log_prob  [..]           natural logarithm of the density at the action

#import action_noise

struct Params {
    rows: u32,
    // Numbers of an action.
    action: u32,
    // The first row in the arrays.
    row: u32,
    // The first row's number in its batch.
    first: u32,
    seed: u32,
    step_counter: u32,
}

@group(0) @binding(0) var<storage, read> mean: array<f32>;
@group(0) @binding(1) var<storage, read> log_std: array<f32>;
@group(0) @binding(2) var<storage, read_write> action: array<f32>;
@group(0) @binding(3) var<storage, read_write> log_prob: array<f32>;
@group(0) @binding(4) var<uniform> params: Params;

const HALF_LOG_TAU = 0.9189385;

@compute @workgroup_size(64)
fn sample_action(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.rows) { return; }
    let row = params.row + id.x;
    var sum = 0.0;
    for (var i = 0u; i < params.action; i++) {
        let noise = action_noise(params.seed, params.first + id.x, params.step_counter, i);
        let at = row * params.action + i;
        action[at] = mean[at] + exp(log_std[i]) * noise;
        sum -= 0.5 * noise * noise + log_std[i] + HALF_LOG_TAU;
    }
    log_prob[row] = sum;
}
