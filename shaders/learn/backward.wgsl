// The gradient with respect to what comes into a layer of both networks, before the bend below it. One
// invocation an input of BLOCK rows.
//
// plan    see network
// turned  [parameters]                     weights as [outputs][inputs]
// rows    [rows, to whole blocks][pitch]
// slopes  [rows, to whole blocks][pitch]   read above the layer, written below it

#import network

struct Params {
    // The actor's place; the critic's is the next.
    first: u32,
}

@group(0) @binding(0) var<storage, read> plan: Plan;
@group(0) @binding(1) var<storage, read> turned: array<f32>;
@group(0) @binding(2) var<storage, read> rows: array<f32>;
@group(0) @binding(3) var<storage, read_write> slopes: array<f32>;
@group(0) @binding(4) var<uniform> params: Params;

@compute @workgroup_size(32)
fn backward(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let place = plan.places[params.first + group.z];
    let input = group.x * 32u + local;
    if (input >= place.inputs) { return; }
    let pitch = plan.pitch;
    let first = group.y * BLOCK * pitch;
    var low = vec4f(0.0);
    var high = vec4f(0.0);
    for (var o = 0u; o < place.outputs; o++) {
        let weight = turned[place.weights + o * place.inputs + input];
        let at = first + place.above + o;
        low += weight * vec4f(slopes[at], slopes[at + pitch], slopes[at + 2u * pitch], slopes[at + 3u * pitch]);
        let on = at + 4u * pitch;
        high += weight * vec4f(slopes[on], slopes[on + pitch], slopes[on + 2u * pitch], slopes[on + 3u * pitch]);
    }
    // tanh' = 1 - tanh^2
    let at = first + place.below + input;
    for (var r = 0u; r < 4u; r++) {
        let below = rows[at + r * pitch];
        slopes[at + r * pitch] = low[r] * (1.0 - below * below);
        let on = at + (r + 4u) * pitch;
        slopes[on] = high[r] * (1.0 - rows[on] * rows[on]);
    }
}
