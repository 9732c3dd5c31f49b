// Whether the character runs into an obstacle at any of the six frames it is about to play; the
// obstacles move along. One invocation an environment.
//
// candidates  [candidates]          database frame of every candidate
// matched     [envs]                candidate found by the search
// path        [frames][4]           ground place and heading of every frame in its clip
// boxes       [envs][BOX][count]    where they are before the step
// drift       [envs][DRIFT][count]
// real        [REALS][envs]         where the character is before the step
// whole       [WHOLES][envs]        STRUCK is written

#import layout
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
@group(0) @binding(4) var<storage, read> drift: array<f32>;
@group(0) @binding(5) var<storage, read> real: array<f32>;
@group(0) @binding(6) var<storage, read_write> whole: array<u32>;
@group(0) @binding(7) var<uniform> params: Params;

const PLAYED = 6u;

@compute @workgroup_size(64)
fn collide(@builtin(global_invocation_id) id: vec3u) {
    let env = id.x;
    let envs = params.envs;
    let count = params.count;
    if (env >= envs) { return; }
    let at = vec2f(real[X * envs + env], real[Z * envs + env]);
    let heading = vec2f(real[HEADING_X * envs + env], real[HEADING_Z * envs + env]);
    let frame = candidates[matched[env]];
    let origin = path[frame];
    var points: array<vec2f, 6>;
    for (var k = 0u; k < PLAYED; k++) {
        let moved = to_local(path[frame + k + 1u].xy - origin.xy, origin.zw);
        points[k] = at + to_world(moved, heading);
    }
    var struck = 0u;
    for (var slot = 0u; slot < count; slot++) {
        let i = env * BOX * count + slot;
        let half = vec2f(boxes[i + HALF_X * count], boxes[i + HALF_Z * count]);
        let v = env * DRIFT * count + slot;
        for (var k = 0u; k < PLAYED; k++) {
            let time = f32(k + 1u) * params.frame_time;
            let x = bounce(boxes[i], drift[v], time, params.square);
            let z = bounce(boxes[i + count], drift[v + count], time, params.square);
            if (inside(points[k], vec2f(x.place, z.place), half)) { struck = 1u; }
        }
    }
    whole[STRUCK * envs + env] = struck;
}
