// PPO's loss of every row (Schulman et al. 2017, equations 7 to 9): its gradient with respect to the
// outputs of actor and critic and to log_std, and what is logged of it. One invocation a row.
//
// dims         [4]                  numbers of an observation; where log_std begins; numbers of an action;
//                                    values
// samples      [..][width]          observation, action, old mean, old log probability, advantage,
//                                    targets, old values
// parameters   [parameters]
// old_log_std  [action]
// outputs      [rows][action] mean, then [rows][values]
// output_grads  of the same form
// extras       [rows][action + SUMS]   gradient of log_std; surrogate, value loss, entropy, KL divergence,
//                                    1 where the ratio is out of the clip range

struct Params {
    rows: u32,
    // The first sample.
    start: u32,
    // Numbers of a sample.
    width: u32,
    clip: f32,
    value_clip: f32,
    value_coefficient: f32,
    entropy_coefficient: f32,
    kl_coefficient: f32,
    // 1 where standard deviations are learned, 0 where they stay.
    std_coefficient: f32,
    // 1 / rows of the mean.
    inv_count: f32,
}

@group(0) @binding(0) var<storage, read> dims: array<u32>;
@group(0) @binding(1) var<storage, read> samples: array<f32>;
@group(0) @binding(2) var<storage, read> parameters: array<f32>;
@group(0) @binding(3) var<storage, read> old_log_std: array<f32>;
@group(0) @binding(4) var<storage, read> outputs: array<f32>;
@group(0) @binding(5) var<storage, read_write> output_grads: array<f32>;
@group(0) @binding(6) var<storage, read_write> extras: array<f32>;
@group(0) @binding(7) var<uniform> params: Params;

const SUMS = 5u;
const HALF_LOG_TAU = 0.9189385;

@compute @workgroup_size(64)
fn ppo_loss(@builtin(global_invocation_id) id: vec3u) {
    let row = id.x;
    if (row >= params.rows) { return; }
    let actions = dims[2];
    let mean = row * actions;
    let action = (params.start + row) * params.width + dims[0];
    let old_mean = action + actions;
    let scalar = old_mean + actions;
    let extra = row * (actions + SUMS);

    // The ratio of the action's densities, and the KL divergence of the new Gaussian from the old one.
    var log_ratio = -samples[scalar];
    var kl = 0.0;
    var entropy = 0.0;
    for (var i = 0u; i < actions; i++) {
        let log_std = parameters[dims[1] + i];
        let inv_std = exp(-log_std);
        let noise = (samples[action + i] - outputs[mean + i]) * inv_std;
        let mean_diff = (samples[old_mean + i] - outputs[mean + i]) * inv_std;
        let log_std_diff = old_log_std[i] - log_std;
        log_ratio -= 0.5 * noise * noise + log_std + HALF_LOG_TAU;
        kl += 0.5 * (mean_diff * mean_diff + exp(2.0 * log_std_diff) - 1.0) - log_std_diff;
        entropy += log_std + 0.5 + HALF_LOG_TAU;
    }
    let ratio = exp(log_ratio);
    let clipped = clamp(ratio, 1.0 - params.clip, 1.0 + params.clip);
    let advantage = samples[scalar + 1u];
    // Where the clipped objective is less, nothing depends on the ratio.
    let unclipped = ratio * advantage <= clipped * advantage;
    let d_log_prob = select(0.0, -advantage * ratio, unclipped);
    for (var i = 0u; i < actions; i++) {
        let log_std = parameters[dims[1] + i];
        let inv_std = exp(-log_std);
        let noise = (samples[action + i] - outputs[mean + i]) * inv_std;
        let mean_diff = (samples[old_mean + i] - outputs[mean + i]) * inv_std;
        let var_ratio = exp(2.0 * (old_log_std[i] - log_std));
        let d_mean = d_log_prob * noise - params.kl_coefficient * mean_diff;
        output_grads[mean + i] = d_mean * inv_std * params.inv_count;
        let d_std = d_log_prob * (noise * noise - 1.0);
        let kl_std = params.kl_coefficient * (1.0 - var_ratio - mean_diff * mean_diff);
        extras[extra + i] =
            params.std_coefficient * (d_std + kl_std - params.entropy_coefficient) * params.inv_count;
    }

    let values = dims[3];
    var value_loss = 0.0;
    for (var i = 0u; i < values; i++) {
        let at = params.rows * actions + row * values + i;
        let error = outputs[at] - samples[scalar + 2u + i];
        let change = outputs[at] - samples[scalar + 2u + values + i];
        let limit = params.value_clip;
        let near = error - change + clamp(change, -limit, limit);
        // Where the limited change counts, nothing depends on the value.
        let limited = limit > 0.0 && abs(change) > limit && near * near > error * error;
        output_grads[at] = select(error * params.value_coefficient * params.inv_count, 0.0, limited);
        value_loss += 0.5 * select(error * error, near * near, limited);
    }

    let sums = extra + actions;
    extras[sums] = -min(ratio * advantage, clipped * advantage);
    extras[sums + 1u] = value_loss;
    extras[sums + 2u] = entropy;
    extras[sums + 3u] = kl;
    extras[sums + 4u] = select(1.0, 0.0, ratio == clipped);
}
