// What the tasks `punch` and `joystick` add to the observation of the body, in its heading frame. One
// invocation an environment.
//
// poses        [bodies * 7][envs]; the target is the last body
// dynamics     see `smooth_dynamics`: the velocities of the same state, from `velocities_at` on
// task_state   [PUNCH_STATE][envs]
// termination  [envs]: how the last step ended
// observation  rows of `width`, from `at` on: direction of the target (2); its distance over 5 m; its position,
//              within 1.5 m (2), and height; 1 after a hit; its rotation (6), its velocity against the
//              root's (3) and its angular velocity (3) over 5; the wanted direction of moving (2) and facing (2)
//              of the joystick

#import spatial
#import punch

struct Params {
    envs: u32,
    at: u32,
    width: u32,
    only: u32, // environments whose step ended as one of these, 1 << termination
    velocities_at: u32,
    target_body: u32,
    joystick: u32,
}

@group(0) @binding(0) var<storage, read_write> poses: array<f32>;
@group(0) @binding(1) var<storage, read_write> dynamics: array<f32>;
@group(0) @binding(2) var<storage, read_write> task_state: array<f32>;
@group(0) @binding(3) var<storage, read_write> termination: array<u32>;
@group(0) @binding(4) var<storage, read_write> observation: array<f32>;
@group(0) @binding(5) var<uniform> params: Params;

var<private> env: u32;
var<private> cursor: u32;
var<private> heading: vec2f;

fn pose(at: u32) -> f32 { return poses[at * params.envs + env]; }
fn carried(field: u32) -> f32 { return task_state[field * params.envs + env]; }

fn velocity3(at: u32) -> vec3f {
    let first = (params.velocities_at + at) * params.envs + env;
    return vec3f(dynamics[first], dynamics[first + params.envs], dynamics[first + 2u * params.envs]);
}

fn put(value: f32) {
    observation[cursor] = value;
    cursor += 1u;
}

fn put2(value: vec2f) {
    put(heading.x * value.x + heading.y * value.y);
    put(heading.x * value.y - heading.y * value.x);
}

fn put3(value: vec3f) {
    put2(value.xy);
    put(value.z);
}

@compute @workgroup_size(64)
fn punch_observe(@builtin(global_invocation_id) id: vec3u) {
    env = id.x;
    if (env >= params.envs) { return; }
    if ((params.only >> termination[env] & 1u) == 0u) { return; }
    cursor = params.at + env * params.width;
    heading = heading_of(vec4f(pose(3u), pose(4u), pose(5u), pose(6u)));
    let b = 7u * params.target_body;
    let gap = vec2f(pose(b) - pose(0u), pose(b + 1u) - pose(1u));
    let distance = length(gap);
    put2(unit2(gap));
    put(0.2 * distance);
    put2(gap * min(1.0, 1.5 / max(distance, 1e-6)));
    put(pose(b + 2u));
    put(select(0.0, 1.0, carried(HIT_STEPS) > 0.0));
    let rotation = vec4f(pose(b + 3u), pose(b + 4u), pose(b + 5u), pose(b + 6u));
    put3(rotate(rotation, vec3f(1.0, 0.0, 0.0)));
    put3(rotate(rotation, vec3f(0.0, 0.0, 1.0)));
    let v = 6u * params.target_body;
    put3(0.2 * (velocity3(v + 3u) - velocity3(3u)));
    put3(0.2 * velocity3(v));
    if (params.joystick == 0u) { return; }
    put2(vec2f(carried(MOVING), carried(MOVING + 1u)));
    put2(vec2f(carried(FACING), carried(FACING + 1u)));
}
