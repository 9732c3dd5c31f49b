// Which moment of the references an episode of the task `track` begins in. One invocation an environment.
//
// mask        [envs]: not 0 where an episode begins
// start_rows  [count][2]: of each start state its row, and the last row of its motion
// task_state  [TRACK_STATE][envs]

#import rng
#import start_draw
#import track

struct Params {
    envs: u32,
    first: u32,
    seed: u32,
    reset_counter: u32,
    count: u32,
}

@group(0) @binding(0) var<storage, read_write> mask: array<u32>;
@group(0) @binding(1) var<storage, read_write> start_rows: array<u32>;
@group(0) @binding(2) var<storage, read_write> task_state: array<f32>;
@group(0) @binding(3) var<uniform> params: Params;

@compute @workgroup_size(64)
fn begin_track(@builtin(global_invocation_id) id: vec3u) {
    let env = id.x;
    if (env >= params.envs) { return; }
    if (mask[env] == 0u) { return; }
    let start = 2u * start_of(params.seed, params.first + env, params.reset_counter, params.count);
    task_state[ROW * params.envs + env] = f32(start_rows[start]);
    task_state[LAST * params.envs + env] = f32(start_rows[start + 1u]);
}
