// What the policy sees: the normalised pose feature of the frame now shown, the target in the
// character frame and, where there are obstacles, the two maps, channels last. `rows` invocations
// an environment: one for each row of its maps, or 1 without maps; the first writes the rest too.
//
// features     [frames][4 * QUADS]   normalised features, padded with zeros
// state_f32    [STATE_F32_FIELDS][envs]
// state_u32    [STATE_U32_FIELDS][envs]
// termination  [.. + envs]           read from `offset` on; only rows that ended in one of the ways
//                                    of `only` (bits, 1 << end) are written
// maps         [envs][MAPS][CELLS][ROW]   see sense; a full byte is 1
// observation  [.. + envs][width]    written from `to` on; width is BASE_OBS_DIM + rows * CELLS * MAPS with
//                                    maps, else BASE_OBS_DIM

#import locomotion_layout
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
@group(0) @binding(1) var<storage, read> state_f32: array<f32>;
@group(0) @binding(2) var<storage, read> state_u32: array<u32>;
@group(0) @binding(3) var<storage, read> termination: array<u32>;
@group(0) @binding(4) var<storage, read> maps: array<u32>;
@group(0) @binding(5) var<storage, read_write> observation: array<f32>;
@group(0) @binding(6) var<uniform> params: Params;

@compute @workgroup_size(64)
fn observe(@builtin(global_invocation_id) id: vec3u) {
    let env = id.x / params.rows;
    let row = id.x % params.rows;
    let envs = params.envs;
    if (env >= envs) { return; }
    if ((params.only >> termination[params.offset + env] & 1u) == 0u) { return; }
    let out = (params.to + env) * params.width;
    if (params.width > BASE_OBS_DIM) {
        for (var map = 0u; map < MAPS; map++) {
            let first = ((env * MAPS + map) * CELLS + row) * ROW;
            for (var column = 0u; column < CELLS; column++) {
                let byte = maps[first + column / 4u] >> (column % 4u * 8u) & 255u;
                observation[out + BASE_OBS_DIM + (row * CELLS + column) * MAPS + map] = f32(byte) / 255.0;
            }
        }
    }
    if (row > 0u) { return; }
    let feature = state_u32[FRAME * envs + env] * 4u * QUADS;
    for (var i = 0u; i < POSE_DIM; i++) {
        observation[out + i] = features[feature + i];
    }
    let heading = vec2f(state_f32[HEADING_X * envs + env], state_f32[HEADING_Z * envs + env]);
    let offset = vec2f(
        state_f32[TARGET_X * envs + env] - state_f32[X * envs + env],
        state_f32[TARGET_Z * envs + env] - state_f32[Z * envs + env],
    );
    let goal = to_local(offset, heading) * TARGET_SCALE;
    observation[out + POSE_DIM] = goal.x;
    observation[out + POSE_DIM + 1u] = goal.y;
}
