// The two obstacle maps: 16 x 16 cell centres over 6 x 6 m in the character frame, one bit each, set
// if inside an obstacle. The map of now becomes the previous one, but in a new episode both are
// alike. Paper: section 4, figure 2. One invocation a row of an environment's map.
//
// boxes  [envs][BOX][count]
// real   [REALS][envs]
// whole  [WHOLES][envs]
// maps   [envs][MAPS][CELLS]   bits of a row from right to left; rows from behind to ahead

#import layout
#import math
#import obstacles

struct Params {
    envs: u32,
    count: u32,
    // 1: only the episodes that have just begun; 0: only the others.
    begun: u32,
}

@group(0) @binding(0) var<storage, read> boxes: array<f32>;
@group(0) @binding(1) var<storage, read> real: array<f32>;
@group(0) @binding(2) var<storage, read> whole: array<u32>;
@group(0) @binding(3) var<storage, read_write> maps: array<u32>;
@group(0) @binding(4) var<uniform> params: Params;

const CELL = 0.375; // m

// A cell's centre along one axis of the character frame, m. Exact in floating point.
fn centre(cell: u32) -> f32 {
    return (f32(cell) - 7.5) * CELL;
}

@compute @workgroup_size(64)
fn sense(@builtin(global_invocation_id) id: vec3u) {
    let env = id.x / CELLS;
    let row = id.x % CELLS;
    let envs = params.envs;
    let count = params.count;
    if (env >= envs) { return; }
    let begun = whole[AGE * envs + env] == 0u;
    if (begun != (params.begun == 1u)) { return; }
    let at = vec2f(real[X * envs + env], real[Z * envs + env]);
    let heading = vec2f(real[HEADING_X * envs + env], real[HEADING_Z * envs + env]);
    var points: array<vec2f, 16>;
    for (var column = 0u; column < CELLS; column++) {
        points[column] = at + to_world(vec2f(centre(column), centre(row)), heading);
    }
    var bits = 0u;
    for (var slot = 0u; slot < count; slot++) {
        let i = env * BOX * count + slot;
        let place = vec2f(boxes[i], boxes[i + count]);
        let half = vec2f(boxes[i + HALF_X * count], boxes[i + HALF_Z * count]);
        for (var column = 0u; column < CELLS; column++) {
            bits |= u32(inside(points[column], place, half)) << column;
        }
    }
    let now = env * MAPS * CELLS + row;
    maps[now + CELLS] = select(maps[now], bits, begun);
    maps[now] = bits;
}
