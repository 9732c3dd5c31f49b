// One layer of one or both networks. One invocation an output of BLOCK rows.
//
// plan        see network
// parameters  [parameters]
// rows        [rows, to whole blocks][pitch]   read below the layer, written above it

#import network

struct Params {
    // The places computed: `first` and, with `count` 2, the next.
    first: u32,
    count: u32,
}

@group(0) @binding(0) var<storage, read> plan: Plan;
@group(0) @binding(1) var<storage, read> parameters: array<f32>;
@group(0) @binding(2) var<storage, read_write> rows: array<f32>;
@group(0) @binding(3) var<uniform> params: Params;

// Cut where it is 1 in f32, so that the exponential stays finite.
fn bend(sums: vec4f) -> vec4f {
    return 1.0 - 2.0 / (exp(2.0 * clamp(sums, vec4f(-9.1), vec4f(9.1))) + 1.0);
}

// Rows by the workgroup, outputs by the invocation: a row's number is the same for all neighbours,
// and their weights lie side by side.
@compute @workgroup_size(32)
fn forward(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    if (group.z >= params.count) { return; }
    let place = plan.places[params.first + group.z];
    let output = group.x * 32u + local;
    if (output >= place.outputs) { return; }
    let pitch = plan.pitch;
    let first = group.y * BLOCK * pitch;
    let bias = parameters[place.weights + place.inputs * place.outputs + output];
    var low = vec4f(bias);
    var high = vec4f(bias);
    for (var i = 0u; i < place.inputs; i++) {
        let weight = parameters[place.weights + i * place.outputs + output];
        let at = first + place.below + i;
        low += weight * vec4f(rows[at], rows[at + pitch], rows[at + 2u * pitch], rows[at + 3u * pitch]);
        let on = at + 4u * pitch;
        high += weight * vec4f(rows[on], rows[on + pitch], rows[on + 2u * pitch], rows[on + 3u * pitch]);
    }
    if (place.bent == 1u) {
        low = bend(low);
        high = bend(high);
    }
    let at = first + place.above + output;
    for (var r = 0u; r < 4u; r++) {
        rows[at + r * pitch] = low[r];
        rows[at + (r + 4u) * pitch] = high[r];
    }
}
