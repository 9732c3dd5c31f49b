// Generalised advantage estimation (Schulman et al. 2016, equation 16) over one rollout, of one of its
// `streams` of rewards, each of which has a value of its own.
// One invocation a row, backwards in time. A termination cuts the sum; those of `bootstrap` go on
// with the value of the final observation, the others with nothing.
//
// reward                [steps][rows]
// termination           [steps][rows]
// log_prob_and_value    [steps][rows], then [steps][rows][streams]: the critic's output, normalised
// next_value            [rows][streams]   of the observation after the last step
// final_value           [steps][rows][streams]  of the final observation of an episode that ended there,
//                                         or [rows][streams] if `final_steps` is 1
// scale                 [streams][12]     mean and standard deviation that undo the normalisation come first
// advantage_and_return  [2][steps][rows][streams]   in units of reward

#import termination

struct Params {
    rows: u32,
    steps: u32,
    gamma: f32,
    lambda: f32,
    // Bits, 1 << termination.
    bootstrap: u32,
    final_steps: u32,
    streams: u32,
    stream: u32,
}

@group(0) @binding(0) var<storage, read> reward: array<f32>;
@group(0) @binding(1) var<storage, read> termination: array<u32>;
@group(0) @binding(2) var<storage, read> log_prob_and_value: array<f32>;
@group(0) @binding(3) var<storage, read> next_value: array<f32>;
@group(0) @binding(4) var<storage, read> final_value: array<f32>;
@group(0) @binding(5) var<storage, read> scale: array<f32>;
@group(0) @binding(6) var<storage, read_write> advantage_and_return: array<f32>;
@group(0) @binding(7) var<uniform> params: Params;

const FIELDS = 12u;

fn denormalized(value: f32) -> f32 {
    let at = FIELDS * params.stream;
    return value * scale[at + 1u] + scale[at];
}

@compute @workgroup_size(64)
fn gae(@builtin(global_invocation_id) id: vec3u) {
    let row = id.x;
    if (row >= params.rows) { return; }
    let samples = params.steps * params.rows;
    let streams = params.streams;
    var after = denormalized(next_value[row * streams + params.stream]);
    var sum = 0.0;
    for (var back = 0u; back < params.steps; back++) {
        let at = (params.steps - 1u - back) * params.rows + row;
        let end = termination[at];
        if (end != RUNNING) {
            let source = select(at, row, params.final_steps == 1u);
            let last = denormalized(final_value[source * streams + params.stream]);
            after = select(0.0, last, (params.bootstrap >> end & 1u) == 1u);
            sum = 0.0;
        }
        let now = denormalized(log_prob_and_value[samples + at * streams + params.stream]);
        sum = reward[at] + params.gamma * after - now + params.gamma * params.lambda * sum;
        advantage_and_return[at * streams + params.stream] = sum;
        advantage_and_return[(samples + at) * streams + params.stream] = sum + now;
        after = now;
    }
}
