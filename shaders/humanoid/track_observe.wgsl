// What the task `track` adds to the observation of the body: where it should be a step on, in its heading frame.
// One invocation an environment.
//
// model_table  see `model_table`
// poses        [bodies * 7][envs]
// references   [rows][nq + nv + 12]: positions, velocities, positions of the key bodies
// task_state   [TRACK_STATE][envs]
// termination  [envs]: how the last step ended
// observation  rows of `width`, from `at` on: of the next reference the root's position against the root (3) and
//              its rotation (6), every joint's rotation, 6 of a ball and the angle of a hinge, and all joints'
//              velocities

#import model_table
#import spatial
#import track

struct Params {
    envs: u32,
    at: u32,
    width: u32,
    only: u32, // environments whose step ended as one of these, 1 << termination
    nq: u32,
    nv: u32,
}

@group(0) @binding(0) var<storage, read_write> model_table: array<u32>;
@group(0) @binding(1) var<storage, read_write> poses: array<f32>;
@group(0) @binding(2) var<storage, read_write> references: array<f32>;
@group(0) @binding(3) var<storage, read_write> task_state: array<f32>;
@group(0) @binding(4) var<storage, read_write> termination: array<u32>;
@group(0) @binding(5) var<storage, read_write> observation: array<f32>;
@group(0) @binding(6) var<uniform> params: Params;

var<private> env: u32;
var<private> cursor: u32;
var<private> row: u32;

fn pose(at: u32) -> f32 { return poses[at * params.envs + env]; }
fn wanted(index: u32) -> f32 { return references[row + index]; }
fn wanted3(index: u32) -> vec3f { return vec3f(wanted(index), wanted(index + 1u), wanted(index + 2u)); }
fn wanted_rotation(index: u32) -> vec4f { return normalize(vec4f(wanted3(index + 1u), wanted(index))); }

fn put(value: f32) {
    observation[cursor] = value;
    cursor += 1u;
}

fn put3(heading: vec2f, value: vec3f) {
    put(heading.x * value.x + heading.y * value.y);
    put(heading.x * value.y - heading.y * value.x);
    put(value.z);
}

fn put_rotation(heading: vec2f, rotation: vec4f) {
    put3(heading, rotate(rotation, vec3f(1.0, 0.0, 0.0)));
    put3(heading, rotate(rotation, vec3f(0.0, 0.0, 1.0)));
}

@compute @workgroup_size(64)
fn track_observe(@builtin(global_invocation_id) id: vec3u) {
    env = id.x;
    if (env >= params.envs) { return; }
    if ((params.only >> termination[env] & 1u) == 0u) { return; }
    cursor = params.at + env * params.width;
    let next = min(task_state[ROW * params.envs + env] + 1.0, task_state[LAST * params.envs + env]);
    row = u32(next) * (params.nq + params.nv + 12u);
    let heading = heading_of(vec4f(pose(3u), pose(4u), pose(5u), pose(6u)));
    put3(heading, wanted3(0u) - vec3f(pose(0u), pose(1u), pose(2u)));
    put_rotation(heading, wanted_rotation(3u));
    let straight = vec2f(1.0, 0.0);
    for (var index = 0u; index < model_table[JOINT_COUNT]; index++) {
        let joint = model_table[JOINTS_AT] + index * JOINT;
        let at = model_table[joint + JOINT_Q];
        let kind = model_table[joint + JOINT_KIND];
        if (kind == BALL) { put_rotation(straight, wanted_rotation(at)); }
        if (kind == HINGE) { put(wanted(at)); }
    }
    for (var dof = 6u; dof < model_table[DOF_COUNT]; dof++) { put(wanted(params.nq + dof)); }
}
