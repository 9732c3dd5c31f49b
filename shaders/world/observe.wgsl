// What the policy sees: the normalised pose feature of the frame now shown, the target in the
// character frame and, where there are obstacles, the two maps, channels last. `rows` invocations
// an environment: one for each row of its maps, or 1 without maps; the first writes the rest too.
//
// features     [frames][4 * QUADS]   normalised features, padded with zeros
// real         [REALS][envs]
// whole        [WHOLES][envs]
// ended        [.. + envs]           read from `offset` on; only rows that ended in one of the ways
//                                    of `only` (bits, 1 << end) are written
// maps         [envs][MAPS][CELLS][ROW]   see sense; a full byte is 1
// observation  [.. + envs][width]    written from `to` on; width is GOAL + rows * CELLS * MAPS with
//                                    maps, else GOAL

#import layout
#import math

struct Params {
    envs: u32,
    rows: u32,
    width: u32,
    offset: u32,
    only: u32,
    to: u32,
}

@group(0) @binding(0) var<storage, read> features: array<f32>;
@group(0) @binding(1) var<storage, read> real: array<f32>;
@group(0) @binding(2) var<storage, read> whole: array<u32>;
@group(0) @binding(3) var<storage, read> ended: array<u32>;
@group(0) @binding(4) var<storage, read> maps: array<u32>;
@group(0) @binding(5) var<storage, read_write> observation: array<f32>;
@group(0) @binding(6) var<uniform> params: Params;

@compute @workgroup_size(64)
fn observe(@builtin(global_invocation_id) id: vec3u) {
    let env = id.x / params.rows;
    let row = id.x % params.rows;
    let envs = params.envs;
    if (env >= envs) { return; }
    if ((params.only >> ended[params.offset + env] & 1u) == 0u) { return; }
    let out = (params.to + env) * params.width;
    if (params.width > GOAL) {
        for (var map = 0u; map < MAPS; map++) {
            let first = ((env * MAPS + map) * CELLS + row) * ROW;
            for (var column = 0u; column < CELLS; column++) {
                let byte = maps[first + column / 4u] >> (column % 4u * 8u) & 255u;
                observation[out + GOAL + (row * CELLS + column) * MAPS + map] = f32(byte) / 255.0;
            }
        }
    }
    if (row > 0u) { return; }
    let feature = whole[FRAME * envs + env] * 4u * QUADS;
    for (var i = 0u; i < POSE; i++) {
        observation[out + i] = features[feature + i];
    }
    let heading = vec2f(real[HEADING_X * envs + env], real[HEADING_Z * envs + env]);
    let offset = vec2f(
        real[TARGET_X * envs + env] - real[X * envs + env],
        real[TARGET_Z * envs + env] - real[Z * envs + env],
    );
    let goal = to_local(offset, heading) * GOAL_SCALE;
    observation[out + POSE] = goal.x;
    observation[out + POSE + 1u] = goal.y;
}
