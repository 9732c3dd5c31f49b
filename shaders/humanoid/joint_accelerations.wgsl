// How much the joints of two fighters were accelerated in a step. One invocation a fighter.
//
// state       [nq + nv][envs], after the step: velocities from `positions` on
// task_state  [..][envs], see `boxing`: takes the sums of squared accelerations and the speeds of the joints

#import boxing

struct Params {
    envs: u32,
    positions: u32, // of a world
    dofs: u32,      // of a fighter
    dt: f32,        // s
}

@group(0) @binding(0) var<storage, read_write> state: array<f32>;
@group(0) @binding(1) var<storage, read_write> task_state: array<f32>;
@group(0) @binding(2) var<uniform> params: Params;

@compute @workgroup_size(64)
fn joint_accelerations(@builtin(global_invocation_id) id: vec3u) {
    let env = id.x / 2u;
    let fighter = id.x % 2u;
    let e = params.envs;
    if (env >= e) { return; }
    let joints = params.dofs - ROOT_DOFS;
    let first = params.positions + fighter * params.dofs + ROOT_DOFS;
    var sum = 0.0;
    // Bounded by a buffer, too: see `end_episode`.
    for (var joint = 0u; joint < select(0u, joints, task_state[CLINCH_STEPS * e + env] >= 0.0); joint++) {
        let speed = state[(first + joint) * e + env];
        let before = (JOINT_SPEEDS + fighter * joints + joint) * e + env;
        let acceleration = (speed - task_state[before]) / params.dt;
        sum += acceleration * acceleration;
        task_state[before] = speed;
    }
    task_state[(SQUARED_ACCELERATION + fighter) * e + env] = sum;
}
