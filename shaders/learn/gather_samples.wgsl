// Samples of a rollout in the order of an epoch, one a row. One workgroup a sample.
//
// order                 [samples]
// observation           [samples][observation]
// action                [samples][action]
// mean                  [samples][action]
// log_prob_and_value    [samples], then [samples][streams]
// advantage_and_return  [2][samples][streams]
// scale                 [streams][12]             see rollout_moments
// rows                  [samples][observation + 2 action + 2 + 2 streams]   observation, action, mean, log
//                       probability, the sum of the streams' advantages, their normalised returns, the critic's old outputs in the new normalisation

struct Params {
    samples: u32,
    observation: u32,
    action: u32,
    streams: u32,
}

@group(0) @binding(0) var<storage, read> order: array<u32>;
@group(0) @binding(1) var<storage, read> observation: array<f32>;
@group(0) @binding(2) var<storage, read> action: array<f32>;
@group(0) @binding(3) var<storage, read> mean: array<f32>;
@group(0) @binding(4) var<storage, read> log_prob_and_value: array<f32>;
@group(0) @binding(5) var<storage, read> advantage_and_return: array<f32>;
@group(0) @binding(6) var<storage, read> scale: array<f32>;
@group(0) @binding(7) var<storage, read_write> rows: array<f32>;
@group(0) @binding(8) var<uniform> params: Params;

const LANES = 32u;
const FIELDS = 12u;

@compute @workgroup_size(32)
fn gather_samples(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let sample = group.y * groups.x + group.x;
    if (sample >= params.samples) { return; }
    let n = params.samples;
    let seen = params.observation;
    let acted = params.action;
    let streams = params.streams;
    let start = sample * (seen + 2u * acted + 2u + 2u * streams);
    let origin = order[sample];
    for (var i = lane; i < seen; i += LANES) { rows[start + i] = observation[origin * seen + i]; }
    for (var i = lane; i < acted; i += LANES) {
        rows[start + seen + i] = action[origin * acted + i];
        rows[start + seen + acted + i] = mean[origin * acted + i];
    }
    if (lane > 0u) { return; }
    let scalars = start + seen + 2u * acted;
    var advantage = 0.0;
    for (var stream = 0u; stream < streams; stream++) {
        let at = FIELDS * stream;
        let source = origin * streams + stream;
        let value = log_prob_and_value[n + source] * scale[at + 1u] + scale[at];
        advantage += advantage_and_return[source];
        rows[scalars + 2u + stream] = (advantage_and_return[n * streams + source] - scale[at + 2u]) / scale[at + 3u];
        rows[scalars + 2u + streams + stream] = (value - scale[at + 2u]) / scale[at + 3u];
    }
    rows[scalars] = log_prob_and_value[origin];
    rows[scalars + 1u] = advantage;
}
