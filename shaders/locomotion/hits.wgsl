// How many of the asked-for future positions lie in an obstacle where it is now.
// Paper: equation 5. One invocation an environment.
//
// action     [envs][TRAJECTORY_DIM]    normalised
// normal     [2][TRAJECTORY_DIM]       mean and scale of the trajectory features: value = action / scale + mean
// boxes      [envs][BOX][count]
// state_f32  [STATE_F32_FIELDS][envs]
// state_u32  [STATE_U32_FIELDS][envs]        HITS is written

#import locomotion_layout
#import math
#import obstacles

struct Params {
    envs: u32,
    // Where the first number of the actions is.
    action_at: u32,
    count: u32,
}

@group(0) @binding(0) var<storage, read> action: array<f32>;
@group(0) @binding(1) var<storage, read> normal: array<f32>;
@group(0) @binding(2) var<storage, read> boxes: array<f32>;
@group(0) @binding(3) var<storage, read> state_f32: array<f32>;
@group(0) @binding(4) var<storage, read_write> state_u32: array<u32>;
@group(0) @binding(5) var<uniform> params: Params;

const ASKED = 3u; // future positions: x and z of each, then its heading

@compute @workgroup_size(64)
fn hits(@builtin(global_invocation_id) id: vec3u) {
    let env = id.x;
    let envs = params.envs;
    let count = params.count;
    if (env >= envs) { return; }
    let at = vec2f(state_f32[X * envs + env], state_f32[Z * envs + env]);
    let heading = vec2f(state_f32[HEADING_X * envs + env], state_f32[HEADING_Z * envs + env]);
    let box = env * BOX * count;
    var hit = 0u;
    for (var k = 0u; k < ASKED; k++) {
        let x = 4u * k;
        let asked = vec2f(action[params.action_at + env * TRAJECTORY_DIM + x], action[params.action_at + env * TRAJECTORY_DIM + x + 1u])
            / vec2f(normal[TRAJECTORY_DIM + x], normal[TRAJECTORY_DIM + x + 1u])
            + vec2f(normal[x], normal[x + 1u]);
        let point = at + to_world(asked, heading);
        for (var slot = 0u; slot < count; slot++) {
            let i = box + slot;
            let centre = vec2f(boxes[i], boxes[i + count]);
            if (inside(point, centre, vec2f(boxes[i + HALF_X * count], boxes[i + HALF_Z * count]))) {
                hit++;
                break;
            }
        }
    }
    state_u32[HITS * envs + env] = hit;
}
