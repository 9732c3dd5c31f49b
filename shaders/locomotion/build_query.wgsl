// Motion-matching queries: the pose half of the frame now shown, the trajectory half from the
// action. One invocation an environment.
//
// features   [frames][4 * QUADS]
// state_u32  [STATE_U32_FIELDS][envs]
// action     [envs][TRAJECTORY_DIM]     normalised
// queries    [envs][4 * QUADS]      the last number is 1, see search_score_lanes

#import locomotion_layout

struct Params {
    envs: u32,
    // Where the first number of the actions is.
    action_at: u32,
}

@group(0) @binding(0) var<storage, read> features: array<f32>;
@group(0) @binding(1) var<storage, read> state_u32: array<u32>;
@group(0) @binding(2) var<storage, read> action: array<f32>;
@group(0) @binding(3) var<storage, read_write> queries: array<f32>;
@group(0) @binding(4) var<uniform> params: Params;

@compute @workgroup_size(64)
fn build_query(@builtin(global_invocation_id) id: vec3u) {
    let env = id.x;
    if (env >= params.envs) { return; }
    let row = state_u32[FRAME * params.envs + env] * 4u * QUADS;
    let out = env * 4u * QUADS;
    for (var i = 0u; i < POSE_DIM; i++) {
        queries[out + i] = features[row + i];
    }
    for (var i = 0u; i < TRAJECTORY_DIM; i++) {
        queries[out + POSE_DIM + i] = action[params.action_at + env * TRAJECTORY_DIM + i];
    }
    queries[out + FEATURE_DIM] = 1.0;
}
