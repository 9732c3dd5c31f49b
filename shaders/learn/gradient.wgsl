// The gradient with respect to all parameters, and what else the loss adds up, over each piece of the
// rows. One invocation an output and BLOCK inputs of a layer, or its biases, in a piece.
//
// plan      see network
// rows      [blocks][pitch][HALVES] of vec4
// slopes    [blocks][pitch][HALVES] of vec4
// partials  [pieces][parameters + SUMS]

#import network

struct Params {
    parameters: u32,
}

@group(0) @binding(0) var<storage, read> plan: Plan;
@group(0) @binding(1) var<storage, read> rows: array<vec4f>;
@group(0) @binding(2) var<storage, read> slopes: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> partials: array<f32>;
@group(0) @binding(4) var<uniform> params: Params;

@compute @workgroup_size(LANES)
fn gradient(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let place = plan.places[group.z % plan.count];
    let piece = group.z / plan.count;
    let output = group.x * LANES + local;
    let input = group.y * BLOCK;
    if (output >= place.outputs || input >= place.inputs + BLOCK) { return; }
    let first = piece * plan.piece;
    let end = min(first + plan.piece, (plan.rows + BLOCK - 1u) / BLOCK);
    let to = piece * (params.parameters + SUMS) + place.weights;
    if (input >= place.inputs) {
        // A bias is the weight of an input that is always one.
        var sum = vec4f(0.0);
        for (var block = first; block < end; block++) {
            let at = (block * plan.pitch + place.above + output) * HALVES;
            sum += slopes[at] + slopes[at + 1u];
        }
        partials[to + place.inputs * place.outputs + output] = dot(sum, vec4f(1.0));
        return;
    }
    var low = vec4f(0.0);
    var high = vec4f(0.0);
    for (var block = first; block < end; block++) {
        let above = (block * plan.pitch + place.above + output) * HALVES;
        let at = (block * plan.pitch + place.below + input) * HALVES;
        let s = slopes[above];
        let t = slopes[above + 1u];
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
        let weight = to + (input + i) * place.outputs + output;
        if (input + i < place.inputs) { partials[weight] = low[i]; }
        if (input + i + 4u < place.inputs) { partials[weight + 4u * place.outputs] = high[i]; }
    }
}
