// What normalises the samples of a rollout: means and standard deviations of advantages and returns,
// with the running moments of the returns; of one stream of rewards. One workgroup.
//
// log_prob_and_value    [samples], then [samples][streams]: the critic's output, normalised
// advantage_and_return  [2][samples][streams]   in units of reward
// group                 [samples]      kinds of situations, whose advantages are normalised apart
// moments               [streams][2]   running mean and mean square of the returns
// scale                 [streams][12]  mean and standard deviation of the critic's outputs (read),
//                                      those that come after them, explained variance; the weight of the
//                                      stream, which stays; means and standard deviations of the
//                                      advantages of the groups

struct Params {
    samples: u32,
    // Weight of this rollout in the running moments.
    weight: f32,
    streams: u32,
    stream: u32,
}

@group(0) @binding(0) var<storage, read> log_prob_and_value: array<f32>;
@group(0) @binding(1) var<storage, read> advantage_and_return: array<f32>;
@group(0) @binding(2) var<storage, read> kind: array<u32>;
@group(0) @binding(3) var<storage, read_write> moments: array<f32>;
@group(0) @binding(4) var<storage, read_write> scale: array<f32>;
@group(0) @binding(5) var<uniform> params: Params;

const FIELDS = 12u;
const LEAST_OF_ALL = 0.2; // of the standard deviation of all advantages, for that of a group
const LANES = 256u;
const MIN_STD = 1e-3;

var<workgroup> partial: array<vec4f, 256>;

// Advantage, return, the return's square, the critic's error.
fn numbers(i: u32) -> vec4f {
    let n = params.samples;
    let at = i * params.streams + params.stream;
    let fields = FIELDS * params.stream;
    let target_value = advantage_and_return[n * params.streams + at];
    let value = log_prob_and_value[n + at] * scale[fields + 1u] + scale[fields];
    return vec4f(advantage_and_return[at], target_value, target_value * target_value, target_value - value);
}

// Its group, and one more that all are in.
fn member(i: u32) -> vec4f {
    let own = kind[i];
    return vec4f(select(0.0, 1.0, own == 0u), select(0.0, 1.0, own == 1u), select(0.0, 1.0, own == 2u), 1.0);
}

fn advantage_of(i: u32) -> f32 { return advantage_and_return[i * params.streams + params.stream]; }

fn sum_of(lane: u32, own: vec4f) -> vec4f {
    partial[lane] = own;
    workgroupBarrier();
    for (var half = LANES / 2u; half > 0u; half /= 2u) {
        if (lane < half) { partial[lane] += partial[lane + half]; }
        workgroupBarrier();
    }
    let sum = partial[0];
    workgroupBarrier();
    return sum;
}

fn mean(lane: u32, own: vec4f) -> vec4f { return sum_of(lane, own) / f32(params.samples); }

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

    var count = vec4f(0.0);
    sum = vec4f(0.0);
    for (var i = lane; i < n; i += 2u * LANES) {
        count += member(i);
        sum += member(i) * advantage_of(i);
        if (i + LANES < n) {
            count += member(i + LANES);
            sum += member(i + LANES) * advantage_of(i + LANES);
        }
    }
    count = max(sum_of(lane, count), vec4f(1.0));
    let group_mean = sum_of(lane, sum) / count;
    sum = vec4f(0.0);
    for (var i = lane; i < n; i += 2u * LANES) {
        let one = vec4f(advantage_of(i)) - group_mean;
        sum += member(i) * one * one;
        if (i + LANES < n) {
            let other = vec4f(advantage_of(i + LANES)) - group_mean;
            sum += member(i + LANES) * other * other;
        }
    }
    let deviation = sqrt(sum_of(lane, sum) / count);
    if (lane > 0u) { return; }
    let moment = 2u * params.stream;
    let fields = FIELDS * params.stream;
    let newest = mix(vec2f(moments[moment], moments[moment + 1u]), center.yz, params.weight);
    moments[moment] = newest.x;
    moments[moment + 1u] = newest.y;
    scale[fields + 2u] = newest.x;
    scale[fields + 3u] = sqrt(max(newest.y - newest.x * newest.x, MIN_STD * MIN_STD));
    let group_std = max(deviation, vec4f(LEAST_OF_ALL * deviation.w));
    for (var own = 0u; own < 3u; own++) {
        scale[fields + 6u + own] = group_mean[own];
        scale[fields + 9u + own] = group_std[own];
    }
    scale[fields + 4u] = 1.0 - variance.w / (variance.y + 1e-12);
}
