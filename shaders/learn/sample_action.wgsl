// Draws actions from the policy's Gaussian. One invocation an environment.
//
// mean      [envs][TRAJECTORY_DIM]   of the policy, normalised
// log_std   [TRAJECTORY_DIM]
// action    [envs][TRAJECTORY_DIM]
// log_prob  [envs]               natural logarithm of the density at the action

#import locomotion_layout
#import rng

struct Params {
    envs: u32,
    first: u32,
    seed: u32,
    step_counter: u32,
}

@group(0) @binding(0) var<storage, read> mean: array<f32>;
@group(0) @binding(1) var<storage, read> log_std: array<f32>;
@group(0) @binding(2) var<storage, read_write> action: array<f32>;
@group(0) @binding(3) var<storage, read_write> log_prob: array<f32>;
@group(0) @binding(4) var<uniform> params: Params;

const NOISE = 0x4e4f4953u; // random stream
const HALF_LOG_TAU = 0.9189385;

@compute @workgroup_size(64)
fn sample_action(@builtin(global_invocation_id) id: vec3u) {
    let env = id.x;
    if (env >= params.envs) { return; }
    var sum = 0.0;
    for (var i = 0u; i < TRAJECTORY_DIM; i++) {
        let noise = gaussian(random4(params.seed, params.first + env, params.step_counter, NOISE + i));
        let at = env * TRAJECTORY_DIM + i;
        action[at] = mean[at] + exp(log_std[i]) * noise;
        sum -= 0.5 * noise * noise + log_std[i] + HALF_LOG_TAU;
    }
    log_prob[env] = sum;
}
