// The gradient with respect to all parameters, and what else the loss adds up, over each piece of the
// rows. One invocation an output and BLOCK inputs of a layer, or its biases, in a piece.
//
// plan      see network
// rows      [rows][pitch]
// slopes    [rows][pitch]
// partials  [pieces][parameters + SUMS]

#import network

struct Params {
    parameters: u32,
}

@group(0) @binding(0) var<storage, read> plan: Plan;
@group(0) @binding(1) var<storage, read> rows: array<f32>;
@group(0) @binding(2) var<storage, read> slopes: array<f32>;
@group(0) @binding(3) var<storage, read_write> partials: array<f32>;
@group(0) @binding(4) var<uniform> params: Params;

@compute @workgroup_size(32)
fn gradient(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let place = plan.places[group.z % plan.count];
    let piece = group.z / plan.count;
    let output = group.x * 32u + local;
    let input = group.y * BLOCK;
    if (output >= place.outputs || input >= place.inputs + BLOCK) { return; }
    let first = piece * plan.piece;
    let end = min(first + plan.piece, plan.rows);
    let to = piece * (params.parameters + SUMS) + place.weights;
    if (input >= place.inputs) {
        // A bias is the weight of an input that is always one.
        var sum = 0.0;
        for (var row = first; row < end; row++) {
            sum += slopes[row * plan.pitch + place.above + output];
        }
        partials[to + place.inputs * place.outputs + output] = sum;
        return;
    }
    var low = vec4f(0.0);
    var high = vec4f(0.0);
    for (var row = first; row < end; row++) {
        let at = row * plan.pitch + place.below + input;
        let slope = slopes[row * plan.pitch + place.above + output];
        low += slope * vec4f(rows[at], rows[at + 1u], rows[at + 2u], rows[at + 3u]);
        high += slope * vec4f(rows[at + 4u], rows[at + 5u], rows[at + 6u], rows[at + 7u]);
    }
    for (var i = 0u; i < 4u; i++) {
        let weight = to + (input + i) * place.outputs + output;
        if (input + i < place.inputs) { partials[weight] = low[i]; }
        if (input + i + 4u < place.inputs) { partials[weight + 4u * place.outputs] = high[i]; }
    }
}
