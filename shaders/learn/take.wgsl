// Begins the rows of a minibatch with what was observed. One invocation a number.
//
// plan     see network
// samples  [..][width]     observations first
// rows     [rows][pitch]

#import layout
#import network

struct Params {
    rows: u32,
    // The minibatch's first sample.
    start: u32,
    width: u32,
}

@group(0) @binding(0) var<storage, read> plan: Plan;
@group(0) @binding(1) var<storage, read> samples: array<f32>;
@group(0) @binding(2) var<storage, read_write> rows: array<f32>;
@group(0) @binding(3) var<uniform> params: Params;

@compute @workgroup_size(64)
fn take(@builtin(global_invocation_id) id: vec3u) {
    let row = id.x / GOAL;
    let column = id.x % GOAL;
    if (row >= params.rows) { return; }
    rows[row * plan.pitch + column] = samples[(params.start + row) * params.width + column];
}
