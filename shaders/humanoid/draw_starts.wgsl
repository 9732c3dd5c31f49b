// Draws where ended episodes begin anew. One invocation an environment.
//
// mask          [envs]: not 0 where to draw
// start_states  [count][width]: positions and velocities to draw from
// starts        [width][envs]: those drawn; the others stay

#import rng
#import start_draw

struct Params {
    envs: u32,
    first: u32,
    seed: u32,
    reset_counter: u32,
    count: u32,
    width: u32,
}

@group(0) @binding(0) var<storage, read_write> mask: array<u32>;
@group(0) @binding(1) var<storage, read_write> start_states: array<f32>;
@group(0) @binding(2) var<storage, read_write> starts: array<f32>;
@group(0) @binding(3) var<uniform> params: Params;

@compute @workgroup_size(64)
fn draw_starts(@builtin(global_invocation_id) id: vec3u) {
    let env = id.x;
    if (env >= params.envs) { return; }
    if (mask[env] == 0u) { return; }
    let drawn = start_of(params.seed, params.first + env, params.reset_counter, params.count);
    let start = drawn * params.width;
    for (var k = 0u; k < params.width; k++) { starts[k * params.envs + env] = start_states[start + k]; }
}
