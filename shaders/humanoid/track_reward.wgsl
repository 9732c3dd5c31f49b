// Reward, measures and end of a step of the task `track` (Peng et al., "DeepMimic", 2018, equations 5 to 9, with
// the root in place of the centre of mass). One invocation an environment.
//
// model_table  see `model_table`
// state        [nq + nv][envs], after the step
// poses        [bodies * 7][envs], of that state
// references   [rows][nq + nv + 12]: positions, velocities, positions of the key bodies
// task_state   [TRACK_STATE][envs]
// reward       [envs], from `at` on
// measures     [2][envs]: distance of the root from its reference, m; mean distance of the key bodies, m
// task_end     [envs]

#import model_table
#import state
#import spatial
#import termination
#import track

struct Params {
    envs: u32,
    at: u32,
    nq: u32,
    nv: u32,
    right_hand: u32,
    left_hand: u32,
    right_foot: u32,
    left_foot: u32,
    max_distance: f32, // of the root from its reference, m
}

@group(0) @binding(0) var<storage, read_write> model_table: array<u32>;
@group(0) @binding(1) var<storage, read_write> state: array<f32>;
@group(0) @binding(2) var<storage, read_write> poses: array<f32>;
@group(0) @binding(3) var<storage, read_write> references: array<f32>;
@group(0) @binding(4) var<storage, read_write> task_state: array<f32>;
@group(0) @binding(5) var<storage, read_write> reward: array<f32>;
@group(0) @binding(6) var<storage, read_write> measures: array<f32>;
@group(0) @binding(7) var<storage, read_write> task_end: array<u32>;
@group(0) @binding(8) var<uniform> params: Params;

var<private> row: u32;

fn wanted(index: u32) -> f32 { return references[row + index]; }
fn wanted3(index: u32) -> vec3f { return vec3f(wanted(index), wanted(index + 1u), wanted(index + 2u)); }
fn wanted_rotation(index: u32) -> vec4f { return normalize(vec4f(wanted3(index + 1u), wanted(index))); }

// Squared angle between two rotations, rad^2.
fn apart(a: vec4f, b: vec4f) -> f32 {
    let angle = 2.0 * acos(min(abs(dot(a, b)), 1.0));
    return angle * angle;
}

// Squared differences of all joints' rotations.
fn pose_error() -> f32 {
    var sum = 0.0;
    for (var index = 0u; index < model_table[JOINT_COUNT]; index++) {
        let joint = model_table[JOINTS_AT] + index * JOINT;
        let at = model_table[joint + JOINT_Q];
        let kind = model_table[joint + JOINT_KIND];
        if (kind == BALL) { sum += apart(q_rotation(at), wanted_rotation(at)); }
        if (kind == HINGE) { sum += (q(at) - wanted(at)) * (q(at) - wanted(at)); }
    }
    return sum;
}

fn velocity_error() -> f32 {
    var sum = 0.0;
    for (var dof = 6u; dof < model_table[DOF_COUNT]; dof++) {
        let off = v(dof) - wanted(params.nq + dof);
        sum += off * off;
    }
    return sum;
}

fn key_distance(body: u32, key: u32) -> f32 {
    let e = params.envs;
    let at = 7u * body * e + env;
    return distance(vec3f(poses[at], poses[at + e], poses[at + 2u * e]), wanted3(params.nq + params.nv + 3u * key));
}

@compute @workgroup_size(64)
fn track_reward(@builtin(global_invocation_id) id: vec3u) {
    env = id.x;
    if (env >= params.envs) { return; }
    let e = params.envs;
    let now = task_state[ROW * e + env] + 1.0;
    task_state[ROW * e + env] = now;
    row = u32(now) * (params.nq + params.nv + 12u);
    let keys = vec4f(key_distance(params.right_hand, 0u), key_distance(params.left_hand, 1u),
        key_distance(params.right_foot, 2u), key_distance(params.left_foot, 3u));
    let root = distance(q3(0u), wanted3(0u));
    reward[params.at + env] = 0.65 * exp(-2.0 * pose_error()) + 0.1 * exp(-0.1 * velocity_error())
        + 0.15 * exp(-40.0 * dot(keys, keys)) + 0.1 * exp(-10.0 * root * root);
    measures[env] = root;
    measures[e + env] = 0.25 * (keys.x + keys.y + keys.z + keys.w);
    let over = select(RUNNING, TRUNCATED, now >= task_state[LAST * e + env]);
    task_end[env] = select(over, FAILED, root > params.max_distance);
}
