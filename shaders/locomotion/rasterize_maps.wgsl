// The two obstacle maps: 16 x 16 cell centres over 6 x 6 m in the character frame. A cell is 1 in an
// obstacle and 0 outside; with `edge` it rises from 0 to 1 over that width across an obstacle's edge,
// so that it tells where in the cell the edge lies. The other map is the one of the previous step as
// it was seen then (in a new episode that of now) or, with `back`, what was there so long ago, seen
// from where the character is now. Paper: section 4, figure 2, where both are 0. One invocation a row
// of an environment's maps.
//
// boxes              [envs][BOX][count]
// obstacle_velocity  [envs][VELOCITY_DIM][count]
// state_f32          [STATE_F32_FIELDS][envs]
// state_u32          [STATE_U32_FIELDS][envs]
// maps               [envs][MAPS][CELLS][ROW]   a byte a cell, from right to left; rows from behind to ahead

#import locomotion_layout
#import math
#import obstacles

struct Params {
    envs: u32,
    count: u32,
    // 1: only the episodes that have just begun; 0: only the others.
    just_reset: u32,
    square: f32,
    // m
    edge: f32,
    // s
    back: f32,
}

@group(0) @binding(0) var<storage, read> boxes: array<f32>;
@group(0) @binding(1) var<storage, read> obstacle_velocity: array<f32>;
@group(0) @binding(2) var<storage, read> state_f32: array<f32>;
@group(0) @binding(3) var<storage, read> state_u32: array<u32>;
@group(0) @binding(4) var<storage, read_write> maps: array<u32>;
@group(0) @binding(5) var<uniform> params: Params;

const CELL = 0.375; // m

// A cell's centre along one axis of the character frame, m. Exact in floating point.
fn centre(cell: u32) -> f32 {
    return (f32(cell) - 7.5) * CELL;
}

// A cell's byte, `depth` metres inside an obstacle.
fn shade(depth: f32) -> u32 {
    if (params.edge == 0.0) { return select(0u, 255u, depth >= 0.0); }
    return u32(clamp(0.5 + depth / params.edge, 0.0, 1.0) * 255.0 + 0.5);
}

@compute @workgroup_size(64)
fn rasterize_maps(@builtin(global_invocation_id) id: vec3u) {
    let env = id.x / CELLS;
    let row = id.x % CELLS;
    let envs = params.envs;
    let count = params.count;
    if (env >= envs) { return; }
    let just_reset = state_u32[EPISODE_STEP * envs + env] == 0u;
    if (just_reset != (params.just_reset == 1u)) { return; }
    let at = vec2f(state_f32[X * envs + env], state_f32[Z * envs + env]);
    let heading = vec2f(state_f32[HEADING_X * envs + env], state_f32[HEADING_Z * envs + env]);
    var points: array<vec2f, 16>;
    var depths: array<vec2f, 16>;
    for (var column = 0u; column < CELLS; column++) {
        points[column] = at + to_world(vec2f(centre(column), centre(row)), heading);
        depths[column] = vec2f(-1e30);
    }
    for (var slot = 0u; slot < count; slot++) {
        let i = env * BOX * count + slot;
        let place = vec2f(boxes[i], boxes[i + count]);
        let half = vec2f(boxes[i + HALF_X * count], boxes[i + HALF_Z * count]);
        var before = place;
        if (params.back > 0.0) {
            let j = env * VELOCITY_DIM * count + slot;
            before = vec2f(
                bounce(place.x, -obstacle_velocity[j], params.back, params.square).place,
                bounce(place.y, -obstacle_velocity[j + count], params.back, params.square).place,
            );
        }
        for (var column = 0u; column < CELLS; column++) {
            let point = points[column];
            let deep = vec2f(depth(point, place, half), depth(point, before, half));
            depths[column] = max(depths[column], deep);
        }
    }
    let now = (env * MAPS * CELLS + row) * ROW;
    let other = now + CELLS * ROW;
    for (var word = 0u; word < ROW; word++) {
        var bytes = vec2u(0u);
        for (var i = 0u; i < 4u; i++) {
            let deep = depths[4u * word + i];
            bytes |= vec2u(shade(deep.x), shade(deep.y)) << vec2u(8u * i);
        }
        let seen = select(maps[now + word], bytes.x, just_reset);
        maps[other + word] = select(seen, bytes.y, params.back > 0.0);
        maps[now + word] = bytes.x;
    }
}
