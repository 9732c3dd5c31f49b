// Gradients of all parameters, and the sums of the objective, over each split of the rows. One invocation
// an output and BLOCK inputs of a layer, or its biases, in a split.
//
// batch     see network
// rows      [blocks][row_stride][HALVES] of vec4
// grads     [blocks][row_stride][HALVES] of vec4
// partials  [splits][parameters + sums]

#import network

@group(0) @binding(0) var<storage, read> batch: BatchLayout;
@group(0) @binding(1) var<storage, read> rows: array<vec4f>;
@group(0) @binding(2) var<storage, read> grads: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> partials: array<f32>;

@compute @workgroup_size(LANES)
fn gradient(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let layer = batch.layer[group.z % batch.layers];
    let split = group.z / batch.layers;
    let output = group.x * LANES + local;
    let input = group.y * BLOCK;
    if (output >= layer.outputs || input >= layer.inputs + BLOCK) { return; }
    let first = split * batch.split_blocks;
    let end = min(first + batch.split_blocks, (batch.rows + BLOCK - 1u) / BLOCK);
    let to = split * (batch.parameters + batch.sums) + layer.weights;
    if (input >= layer.inputs) {
        // A bias is the weight of an input that is always one.
        var sum = vec4f(0.0);
        for (var block = first; block < end; block++) {
            let at = (block * batch.row_stride + layer.output_col + output) * HALVES;
            sum += grads[at] + grads[at + 1u];
        }
        partials[to + layer.inputs * layer.outputs + output] = dot(sum, vec4f(1.0));
        return;
    }
    var low = vec4f(0.0);
    var high = vec4f(0.0);
    for (var block = first; block < end; block++) {
        let above = (block * batch.row_stride + layer.output_col + output) * HALVES;
        let at = (block * batch.row_stride + layer.input_col + input) * HALVES;
        let s = grads[above];
        let t = grads[above + 1u];
        low += vec4f(
            dot(s, rows[at]) + dot(t, rows[at + 1u]),
            dot(s, rows[at + 2u]) + dot(t, rows[at + 3u]),
            dot(s, rows[at + 4u]) + dot(t, rows[at + 5u]),
            dot(s, rows[at + 6u]) + dot(t, rows[at + 7u]),
        );
        high += vec4f(
            dot(s, rows[at + 8u]) + dot(t, rows[at + 9u]),
            dot(s, rows[at + 10u]) + dot(t, rows[at + 11u]),
            dot(s, rows[at + 12u]) + dot(t, rows[at + 13u]),
            dot(s, rows[at + 14u]) + dot(t, rows[at + 15u]),
        );
    }
    for (var i = 0u; i < 4u; i++) {
        let weight = to + (input + i) * layer.outputs + output;
        if (input + i < layer.inputs) { partials[weight] = low[i]; }
        if (input + i + 4u < layer.inputs) { partials[weight + 4u * layer.outputs] = high[i]; }
    }
}
