// PPO's loss of every sample (Schulman et al. 2017, equations 7 to 9) and its gradient with respect
// to the networks' answers and log_std. One invocation a row.
//
// plan         see network
// samples      [..][width]                   observation, action, mean, log probability, advantage,
//                                            target, the critic's old value
// parameters   [parameters]                  log_std last
// old_log_std  [TRAJECTORY_DIM]
// answers      [rows][TRAJECTORY_DIM] mean, then [rows] value
// slopes       [blocks][pitch][BLOCK]        their gradients, and the columns that are added up

#import locomotion_layout
#import network

struct Params {
    rows: u32,
    // The minibatch's first sample.
    start: u32,
    width: u32,
    clip: f32,
    value_clip: f32,
    value_coefficient: f32,
    entropy_coefficient: f32,
    kl_coefficient: f32,
    // Of a sample in the mean.
    share: f32,
}

@group(0) @binding(0) var<storage, read> plan: Plan;
@group(0) @binding(1) var<storage, read> samples: array<f32>;
@group(0) @binding(2) var<storage, read> parameters: array<f32>;
@group(0) @binding(3) var<storage, read> old_log_std: array<f32>;
@group(0) @binding(4) var<storage, read> answers: array<f32>;
@group(0) @binding(5) var<storage, read_write> slopes: array<f32>;
@group(0) @binding(6) var<uniform> params: Params;

const HALF_LOG_TAU = 0.9189385;

var<private> row: u32;

fn slope(column: u32, value: f32) {
    let at = (row / BLOCK * plan.pitch + column) * BLOCK + row % BLOCK;
    slopes[at] = select(0.0, value, row < params.rows);
}

@compute @workgroup_size(64)
fn loss(@builtin(global_invocation_id) id: vec3u) {
    // Rows that fill the last block have no slopes.
    row = id.x;
    if (row / BLOCK * BLOCK >= params.rows) { return; }
    let sample = min(row, params.rows - 1u);
    let above_actor = plan.places[plan.count - 3u].above;
    let above_critic = plan.places[plan.count - 2u].above;
    let judged = plan.places[plan.count - 1u].above;
    let mean = sample * TRAJECTORY_DIM;
    let log_std = plan.parameters - TRAJECTORY_DIM;
    let action = (params.start + sample + 1u) * params.width - 2u * TRAJECTORY_DIM - 4u;
    let scalar = action + 2u * TRAJECTORY_DIM;

    // The ratio of the action's densities, and the KL divergence of the old Gaussian from the new one.
    var log_ratio = -samples[scalar];
    var kl = 0.0;
    var entropy = 0.0;
    for (var i = 0u; i < TRAJECTORY_DIM; i++) {
        let log = parameters[log_std + i];
        let inverse = exp(-log);
        let noise = (samples[action + i] - answers[mean + i]) * inverse;
        let moved = (samples[action + TRAJECTORY_DIM + i] - answers[mean + i]) * inverse;
        let spread = old_log_std[i] - log;
        log_ratio -= 0.5 * noise * noise + log + HALF_LOG_TAU;
        kl += 0.5 * (moved * moved + exp(2.0 * spread) - 1.0) - spread;
        entropy += log + 0.5 + HALF_LOG_TAU;
    }
    let ratio = exp(log_ratio);
    let clipped = clamp(ratio, 1.0 - params.clip, 1.0 + params.clip);
    let advantage = samples[scalar + 1u];
    // Where the clipped one is less, nothing depends on the ratio.
    let passes = ratio * advantage <= clipped * advantage;
    let pull = select(0.0, -advantage * ratio, passes);
    for (var i = 0u; i < TRAJECTORY_DIM; i++) {
        let log = parameters[log_std + i];
        let inverse = exp(-log);
        let noise = (samples[action + i] - answers[mean + i]) * inverse;
        let moved = (samples[action + TRAJECTORY_DIM + i] - answers[mean + i]) * inverse;
        let doubled = exp(2.0 * (old_log_std[i] - log));
        let by_mean = pull * noise - params.kl_coefficient * moved;
        slope(above_actor + i, by_mean * inverse * params.share);
        let by_noise = pull * (noise * noise - 1.0);
        let by_kl = params.kl_coefficient * (1.0 - doubled - moved * moved);
        slope(judged + i, (by_noise + by_kl - params.entropy_coefficient) * params.share);
    }

    let value = answers[params.rows * TRAJECTORY_DIM + sample];
    let error = value - samples[scalar + 2u];
    let step = value - samples[scalar + 3u];
    let limit = params.value_clip;
    let near = error - step + clamp(step, -limit, limit);
    // Where the limited change counts, nothing depends on the value.
    let limited = limit > 0.0 && abs(step) > limit && near * near > error * error;
    slope(above_critic, select(error * params.value_coefficient * params.share, 0.0, limited));

    let sums = judged + TRAJECTORY_DIM;
    slope(sums, -min(ratio * advantage, clipped * advantage));
    slope(sums + 1u, 0.5 * select(error * error, near * near, limited));
    slope(sums + 2u, entropy);
    slope(sums + 3u, kl);
    slope(sums + 4u, select(1.0, 0.0, ratio == clipped));
}
