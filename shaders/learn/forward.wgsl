// Outputs of networks, layer after layer. One workgroup a network and BLOCK rows.
//
// batch       see network
// samples     [..][width]                       observations first
// parameters  [copies][parameters]
// copies      [blocks]                          which copy of the parameters evaluates a block, or NO_COPY
// rows        [blocks][row_stride][HALVES] of vec4   observations, and the hidden layers' activations
// outputs     [rows][outputs] of the first network, then of the next

#import network

struct Params {
    rows: u32,
    // The first sample.
    start: u32,
    // Numbers of a sample.
    width: u32,
    // The first network that is evaluated.
    network: u32,
    // Index of the first output.
    out_at: u32,
}

@group(0) @binding(0) var<storage, read> batch: BatchLayout;
@group(0) @binding(1) var<storage, read> samples: array<f32>;
@group(0) @binding(2) var<storage, read> parameters: array<f32>;
@group(0) @binding(3) var<storage, read> copies: array<u32>;
@group(0) @binding(4) var<storage, read_write> rows: array<vec4f>;
@group(0) @binding(5) var<storage, read_write> outputs: array<f32>;
@group(0) @binding(6) var<uniform> params: Params;

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

// tanh is cut where it is 1 in f32, so that the exponential stays finite.
fn activation(sums: vec4f, kind: u32) -> vec4f {
    if (kind == RELU) { return max(sums, vec4f(0.0)); }
    if (kind == TANH) { return 1.0 - 2.0 / (exp(2.0 * clamp(sums, vec4f(-9.1), vec4f(9.1))) + 1.0); }
    return sums;
}

@compute @workgroup_size(LANES)
fn forward(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let network = params.network + group.z;
    let row = group.x * BLOCK;
    if (row >= params.rows || copies[group.x] == NO_COPY) { return; }
    let copy = copies[group.x] * batch.parameters;
    let block = group.x * batch.row_stride;
    let first = batch.first_layer[network];
    let end = batch.first_layer[network + 1u];
    for (var column = local; column < batch.layer[first].inputs; column += LANES) {
        let at = (block + batch.layer[first].input_col + column) * HALVES;
        rows[at] = observe(row, column);
        rows[at + 1u] = observe(row + 4u, column);
    }
    let before = batch.outputs_before[network] - batch.outputs_before[params.network];
    for (var index = first; index < end; index++) {
        // The inputs have been written by the whole workgroup.
        storageBarrier();
        let layer = batch.layer[index];
        for (var output = local; output < layer.outputs; output += LANES) {
            let weights = copy + layer.weights;
            let bias = parameters[weights + layer.inputs * layer.outputs + output];
            var low = vec4f(bias);
            var high = vec4f(bias);
            for (var input = 0u; input < layer.inputs; input++) {
                let weight = parameters[weights + input * layer.outputs + output];
                let at = (block + layer.input_col + input) * HALVES;
                low += weight * rows[at];
                high += weight * rows[at + 1u];
            }
            low = activation(low, layer.activation);
            high = activation(high, layer.activation);
            if (index + 1u < end) {
                let at = (block + layer.output_col + output) * HALVES;
                rows[at] = low;
                rows[at + 1u] = high;
            } else {
                let to = params.out_at + params.rows * before;
                for (var r = 0u; r < BLOCK; r++) {
                    if (row + r >= params.rows) { break; }
                    outputs[to + (row + r) * layer.outputs + output] = select(high[r & 3u], low[r & 3u], r < 4u);
                }
            }
        }
    }
}
