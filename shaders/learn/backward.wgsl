// The gradient with respect to what comes into the layers, from the last down to the second, before the
// bends below them. One workgroup a network and BLOCK rows.
//
// plan    see network
// turned  [parameters]                        weights as [outputs][inputs]
// rows    [blocks][pitch][HALVES] of vec4
// slopes  [blocks][pitch][HALVES] of vec4     read above the last layer, written below

#import network

struct Params {
    rows: u32,
}

@group(0) @binding(0) var<storage, read> plan: Plan;
@group(0) @binding(1) var<storage, read> turned: array<f32>;
@group(0) @binding(2) var<storage, read> rows: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> slopes: array<vec4f>;
@group(0) @binding(4) var<uniform> params: Params;

@compute @workgroup_size(LANES)
fn backward(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    if (group.x * BLOCK >= params.rows) { return; }
    let block = group.x * plan.pitch;
    // What is observed does not learn.
    for (var layer = plan.count - 3u + group.z; layer > 1u; layer -= 2u) {
        // What is above has been written by the whole workgroup.
        storageBarrier();
        let place = plan.places[layer];
        for (var input = local; input < place.inputs; input += LANES) {
            var low = vec4f(0.0);
            var high = vec4f(0.0);
            for (var output = 0u; output < place.outputs; output++) {
                let weight = turned[place.weights + output * place.inputs + input];
                let at = (block + place.above + output) * HALVES;
                low += weight * slopes[at];
                high += weight * slopes[at + 1u];
            }
            // tanh' = 1 - tanh^2
            let at = (block + place.below + input) * HALVES;
            slopes[at] = low * (1.0 - rows[at] * rows[at]);
            slopes[at + 1u] = high * (1.0 - rows[at + 1u] * rows[at + 1u]);
        }
    }
}
