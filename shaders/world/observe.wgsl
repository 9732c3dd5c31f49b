// What the policy sees: the normalised pose feature of the frame now shown, and the target in
// the character frame. One invocation an environment.
//
// features     [frames][4 * QUADS]   normalised features, padded with zeros
// real         [REALS][envs]
// whole        [WHOLES][envs]
// ended        [.. + envs]           read from `offset` on; only rows that ended like `only` are
//                                    written, or all of them if `only` is RUNNING
// observation  [envs][OBSERVATION]

#import layout
#import math

struct Params {
    envs: u32,
    offset: u32,
    only: u32,
}

@group(0) @binding(0) var<storage, read> features: array<f32>;
@group(0) @binding(1) var<storage, read> real: array<f32>;
@group(0) @binding(2) var<storage, read> whole: array<u32>;
@group(0) @binding(3) var<storage, read> ended: array<u32>;
@group(0) @binding(4) var<storage, read_write> observation: array<f32>;
@group(0) @binding(5) var<uniform> params: Params;

@compute @workgroup_size(64)
fn observe(@builtin(global_invocation_id) id: vec3u) {
    let env = id.x;
    let envs = params.envs;
    if (env >= envs) { return; }
    if (params.only != RUNNING && ended[params.offset + env] != params.only) { return; }
    let row = whole[FRAME * envs + env] * 4u * QUADS;
    let out = env * OBSERVATION;
    for (var i = 0u; i < POSE; i++) {
        observation[out + i] = features[row + i];
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
