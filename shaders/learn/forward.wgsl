// Answers to samples, layer after layer. One workgroup a network and BLOCK rows.
//
// plan        see network
// samples     [..][width]                    observations first
// parameters  [parameters]
// rows        [blocks][pitch][HALVES] of vec4   what is observed, and what the hidden layers make of it
// answers     [rows][TRAJECTORY_DIM] of the actor, then [rows] of the critic; or of the one asked

#import locomotion_layout
#import network

struct Params {
    rows: u32,
    // The first sample.
    start: u32,
    width: u32,
    // 0: the actor, or both. 1: the critic.
    first: u32,
}

@group(0) @binding(0) var<storage, read> plan: Plan;
@group(0) @binding(1) var<storage, read> samples: array<f32>;
@group(0) @binding(2) var<storage, read> parameters: array<f32>;
@group(0) @binding(3) var<storage, read_write> rows: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> answers: array<f32>;
@group(0) @binding(5) var<uniform> params: Params;

// Rows that fill the last block observe nothing.
fn observed(row: u32, column: u32) -> f32 {
    let sample = params.start + min(row, params.rows - 1u);
    return select(0.0, samples[sample * params.width + column], row < params.rows);
}

fn observe(row: u32, column: u32) -> vec4f {
    return vec4f(
        observed(row, column), observed(row + 1u, column), observed(row + 2u, column), observed(row + 3u, column),
    );
}

// Cut where it is 1 in f32, so that the exponential stays finite.
fn bend(sums: vec4f) -> vec4f {
    return 1.0 - 2.0 / (exp(2.0 * clamp(sums, vec4f(-9.1), vec4f(9.1))) + 1.0);
}

@compute @workgroup_size(LANES)
fn forward(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let network = params.first + group.z;
    let row = group.x * BLOCK;
    if (row >= params.rows) { return; }
    let block = group.x * plan.pitch;
    for (var column = local; column < BASE_OBS_DIM; column += LANES) {
        let at = (block + plan.places[network].below + column) * HALVES;
        rows[at] = observe(row, column);
        rows[at + 1u] = observe(row + 4u, column);
    }
    for (var layer = network; layer + 1u < plan.count; layer += 2u) {
        // What is below has been written by the whole workgroup.
        storageBarrier();
        let place = plan.places[layer];
        for (var output = local; output < place.outputs; output += LANES) {
            let bias = parameters[place.weights + place.inputs * place.outputs + output];
            var low = vec4f(bias);
            var high = vec4f(bias);
            for (var input = 0u; input < place.inputs; input++) {
                let weight = parameters[place.weights + input * place.outputs + output];
                let at = (block + place.below + input) * HALVES;
                low += weight * rows[at];
                high += weight * rows[at + 1u];
            }
            if (place.bent == 1u) {
                let at = (block + place.above + output) * HALVES;
                rows[at] = bend(low);
                rows[at + 1u] = bend(high);
            } else {
                let first = group.z * params.rows * TRAJECTORY_DIM;
                for (var r = 0u; r < BLOCK; r++) {
                    if (row + r >= params.rows) { break; }
                    answers[first + (row + r) * place.outputs + output] = select(high[r & 3u], low[r & 3u], r < 4u);
                }
            }
        }
    }
}
