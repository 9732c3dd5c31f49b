// Gradients with respect to the sums of all layers, from those of the outputs, from the last layer to the
// first. One workgroup a network and BLOCK rows; the first network's also sorts the extras in.
//
// batch         see network
// parameters    [parameters]
// rows          [blocks][row_stride][HALVES] of vec4
// output_grads  [rows][outputs] of the first network, then of the next
// extras        [rows][extras]
// grads         [blocks][row_stride][HALVES] of vec4

#import network

struct Params {
    rows: u32,
}

@group(0) @binding(0) var<storage, read> batch: BatchLayout;
@group(0) @binding(1) var<storage, read> parameters: array<f32>;
@group(0) @binding(2) var<storage, read> rows: array<vec4f>;
@group(0) @binding(3) var<storage, read> output_grads: array<f32>;
@group(0) @binding(4) var<storage, read> extras: array<f32>;
@group(0) @binding(5) var<storage, read_write> grads: array<vec4f>;
@group(0) @binding(6) var<uniform> params: Params;

// Rows that fill the last block have no gradients.
fn output_grad(row: u32, at: u32, outputs: u32) -> f32 {
    return select(0.0, output_grads[at + min(row, params.rows - 1u) * outputs], row < params.rows);
}

fn extra(row: u32, at: u32, outputs: u32) -> f32 {
    return select(0.0, extras[at + min(row, params.rows - 1u) * outputs], row < params.rows);
}

// From the gradient with respect to activations.
fn activation_backward(grad: vec4f, activation: vec4f, kind: u32) -> vec4f {
    if (kind == RELU) { return select(vec4f(0.0), grad, activation > vec4f(0.0)); }
    if (kind == TANH) { return grad * (1.0 - activation * activation); }
    return grad;
}

@compute @workgroup_size(LANES)
fn backward(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let row = group.x * BLOCK;
    if (row >= params.rows) { return; }
    let block = group.x * batch.row_stride;
    let first = batch.first_layer[group.z];
    let last = batch.first_layer[group.z + 1u] - 1u;
    let outputs = batch.layer[last].outputs;
    for (var output = local; output < outputs; output += LANES) {
        let source = params.rows * batch.outputs_before[group.z] + output;
        let at = (block + batch.layer[last].output_col + output) * HALVES;
        grads[at] = vec4f(
            output_grad(row, source, outputs), output_grad(row + 1u, source, outputs),
            output_grad(row + 2u, source, outputs), output_grad(row + 3u, source, outputs),
        );
        grads[at + 1u] = vec4f(
            output_grad(row + 4u, source, outputs), output_grad(row + 5u, source, outputs),
            output_grad(row + 6u, source, outputs), output_grad(row + 7u, source, outputs),
        );
    }
    let added = batch.layer[batch.layers - 1u];
    if (group.z == 0u) {
        for (var i = local; i < added.outputs; i += LANES) {
            let at = (block + added.output_col + i) * HALVES;
            let n = added.outputs;
            grads[at] = vec4f(extra(row, i, n), extra(row + 1u, i, n), extra(row + 2u, i, n), extra(row + 3u, i, n));
            grads[at + 1u] = vec4f(
                extra(row + 4u, i, n), extra(row + 5u, i, n), extra(row + 6u, i, n), extra(row + 7u, i, n),
            );
        }
    }
    // Observations do not learn.
    for (var index = last; index > first; index--) {
        // The gradients above have been written by the whole workgroup.
        storageBarrier();
        let layer = batch.layer[index];
        let kind = batch.layer[index - 1u].activation;
        for (var input = local; input < layer.inputs; input += LANES) {
            var low = vec4f(0.0);
            var high = vec4f(0.0);
            for (var output = 0u; output < layer.outputs; output++) {
                let weight = parameters[layer.weights + input * layer.outputs + output];
                let at = (block + layer.output_col + output) * HALVES;
                low += weight * grads[at];
                high += weight * grads[at + 1u];
            }
            let at = (block + layer.input_col + input) * HALVES;
            grads[at] = activation_backward(low, rows[at], kind);
            grads[at + 1u] = activation_backward(high, rows[at + 1u], kind);
        }
    }
}
