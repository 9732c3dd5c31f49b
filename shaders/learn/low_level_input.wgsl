// What a low-level policy observes: what a body observes of itself, then the latent that a high level's action
// means, a unit vector. One invocation a row.
//
// observation  [rows][observation], of which the first numbers, the style, are the body's
// action       [rows][latent] from the index `at` on
// widths       [2]: style and latent. In a buffer, for they bound loops: lavapipe compiles a shader anew for every
//              launch in which the uniform alone decides how often a loop runs
// input        [rows][style + latent]

struct Params {
    rows: u32,
    observation: u32,
    at: u32,
}

@group(0) @binding(0) var<storage, read> observation: array<f32>;
@group(0) @binding(1) var<storage, read> action: array<f32>;
@group(0) @binding(2) var<storage, read> widths: array<u32>;
@group(0) @binding(3) var<storage, read_write> input: array<f32>;
@group(0) @binding(4) var<uniform> params: Params;

const LEAST = 1e-6; // a shorter vector has no direction

fn within(at: u32) -> f32 { return clamp(action[at], -1.0, 1.0); }

@compute @workgroup_size(64)
fn low_level_input(@builtin(global_invocation_id) id: vec3u) {
    let row = id.x;
    if (row >= params.rows) { return; }
    let style = widths[0];
    let latent = widths[1];
    let body = row * (style + latent);
    for (var k = 0u; k < style; k++) {
        input[body + k] = observation[row * params.observation + k];
    }
    let first = params.at + row * latent;
    var squares = 0.0;
    for (var k = 0u; k < latent; k++) { squares += within(first + k) * within(first + k); }
    let norm = sqrt(squares);
    for (var k = 0u; k < latent; k++) {
        let axis = select(0.0, 1.0, k == 0u);
        input[body + style + k] = select(within(first + k) / max(norm, LEAST), axis, norm < LEAST);
    }
}
