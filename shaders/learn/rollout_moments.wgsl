// What normalises the samples of a rollout: means and standard deviations of advantages and returns,
// with the running moments of the returns. One workgroup.
//
// log_prob_and_value    [2][samples]   the second half is the critic's output, normalised
// advantage_and_return  [2][samples]   in units of reward
// moments               [2]            running mean and mean square of the returns
// scale                 [7]            mean and standard deviation of the critic's outputs (read),
//                                      those that come after them, mean and standard deviation of the
//                                      advantages, explained variance

struct Params {
    samples: u32,
    // Weight of this rollout in the running moments.
    weight: f32,
}

@group(0) @binding(0) var<storage, read> log_prob_and_value: array<f32>;
@group(0) @binding(1) var<storage, read> advantage_and_return: array<f32>;
@group(0) @binding(2) var<storage, read_write> moments: array<f32>;
@group(0) @binding(3) var<storage, read_write> scale: array<f32>;
@group(0) @binding(4) var<uniform> params: Params;

const LANES = 256u;
const MIN_STD = 1e-3;

var<workgroup> partial: array<vec4f, 256>;

// Advantage, return, the return's square, the critic's error.
fn numbers(i: u32) -> vec4f {
    let n = params.samples;
    let target_value = advantage_and_return[n + i];
    let value = log_prob_and_value[n + i] * scale[1] + scale[0];
    return vec4f(advantage_and_return[i], target_value, target_value * target_value, target_value - value);
}

fn mean(lane: u32, own: vec4f) -> vec4f {
    partial[lane] = own;
    workgroupBarrier();
    for (var half = LANES / 2u; half > 0u; half /= 2u) {
        if (lane < half) { partial[lane] += partial[lane + half]; }
        workgroupBarrier();
    }
    let sum = partial[0];
    workgroupBarrier();
    return sum / f32(params.samples);
}

@compute @workgroup_size(256)
fn rollout_moments(@builtin(local_invocation_index) lane: u32) {
    let n = params.samples;
    // Two samples a round: lavapipe stops after 65,535 of them.
    var sum = vec4f(0.0);
    for (var i = lane; i < n; i += 2u * LANES) {
        sum += numbers(i);
        if (i + LANES < n) { sum += numbers(i + LANES); }
    }
    let center = mean(lane, sum);
    sum = vec4f(0.0);
    for (var i = lane; i < n; i += 2u * LANES) {
        let one = numbers(i) - center;
        sum += one * one;
        if (i + LANES < n) {
            let other = numbers(i + LANES) - center;
            sum += other * other;
        }
    }
    let variance = mean(lane, sum);
    if (lane > 0u) { return; }
    let newest = mix(vec2f(moments[0], moments[1]), center.yz, params.weight);
    moments[0] = newest.x;
    moments[1] = newest.y;
    scale[2] = newest.x;
    scale[3] = sqrt(max(newest.y - newest.x * newest.x, MIN_STD * MIN_STD));
    scale[4] = center.x;
    scale[5] = sqrt(variance.x);
    scale[6] = 1.0 - variance.w / (variance.y + 1e-12);
}
