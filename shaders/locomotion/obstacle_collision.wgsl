// Whether the character runs into an obstacle at any of the six frames it is about to play; the
// obstacles move along. One invocation an environment.
//
// candidates         [candidates]          database frame of every candidate
// matched            [envs]                candidate found by the search
// path               [frames][4]           ground place and heading of every frame in its clip
// boxes              [envs][BOX][count]    where they are before the step
// obstacle_velocity  [envs][VELOCITY_DIM][count]
// state_f32          [STATE_F32_FIELDS][envs]         where the character is before the step
// state_u32          [STATE_U32_FIELDS][envs]        HAS_COLLIDED is written

#import locomotion_layout
#import math
#import obstacles

struct Params {
    envs: u32,
    count: u32,
    square: f32,
    frame_time: f32,
}

@group(0) @binding(0) var<storage, read> candidates: array<u32>;
@group(0) @binding(1) var<storage, read> matched: array<u32>;
@group(0) @binding(2) var<storage, read> path: array<vec4f>;
@group(0) @binding(3) var<storage, read> boxes: array<f32>;
@group(0) @binding(4) var<storage, read> obstacle_velocity: array<f32>;
@group(0) @binding(5) var<storage, read> state_f32: array<f32>;
@group(0) @binding(6) var<storage, read_write> state_u32: array<u32>;
@group(0) @binding(7) var<uniform> params: Params;

const FRAMES_PER_STEP = 6u;

@compute @workgroup_size(64)
fn obstacle_collision(@builtin(global_invocation_id) id: vec3u) {
    let env = id.x;
    let envs = params.envs;
    let count = params.count;
    if (env >= envs) { return; }
    let at = vec2f(state_f32[X * envs + env], state_f32[Z * envs + env]);
    let heading = vec2f(state_f32[HEADING_X * envs + env], state_f32[HEADING_Z * envs + env]);
    let frame = candidates[matched[env]];
    let origin = path[frame];
    var points: array<vec2f, 6>;
    for (var k = 0u; k < FRAMES_PER_STEP; k++) {
        let moved = to_local(path[frame + k + 1u].xy - origin.xy, origin.zw);
        points[k] = at + to_world(moved, heading);
    }
    var struck = 0u;
    for (var slot = 0u; slot < count; slot++) {
        let i = env * BOX * count + slot;
        let half = vec2f(boxes[i + HALF_X * count], boxes[i + HALF_Z * count]);
        let v = env * VELOCITY_DIM * count + slot;
        for (var k = 0u; k < FRAMES_PER_STEP; k++) {
            let time = f32(k + 1u) * params.frame_time;
            let x = bounce(boxes[i], obstacle_velocity[v], time, params.square);
            let z = bounce(boxes[i + count], obstacle_velocity[v + count], time, params.square);
            if (inside(points[k], vec2f(x.place, z.place), half)) { struck = 1u; }
        }
    }
    state_u32[HAS_COLLIDED * envs + env] = struck;
}
