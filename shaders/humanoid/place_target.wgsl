// Stands the target of the tasks `punch` and `joystick` somewhere around the character of every episode that
// begins, and says where it is to face and to move. One invocation an environment.
//
// mask        [envs]: not 0 where an episode begins
// starts      [nq + nv][envs]: the positions of the target's free joint from `target_q` on, at rest from
//             `nq + target_v` on
// task_state  [PUNCH_STATE][envs]

#import rng
#import punch

struct Params {
    envs: u32,
    first: u32,
    seed: u32,
    step_counter: u32,
    nq: u32,
    target_q: u32,
    target_v: u32,
    near_share: f32,     // of the targets that are near
    near_least: f32,     // m, of those
    near_most: f32,
    near_bearing: f32,   // rad, of those from the heading
    least: f32,          // m, of the others
    most: f32,
    height: f32,         // m, of the target's centre
    facing_power: f32,   // 1 if the wanted facing is any, more if it is the more often near the way
}

@group(0) @binding(0) var<storage, read_write> mask: array<u32>;
@group(0) @binding(1) var<storage, read_write> starts: array<f32>;
@group(0) @binding(2) var<storage, read_write> task_state: array<f32>;
@group(0) @binding(3) var<uniform> params: Params;

const STREAM = 0x54415247u;
const PI = 3.1415927;

var<private> env: u32;

fn assign(field: u32, value: f32) { starts[field * params.envs + env] = value; }
fn carry(field: u32, value: f32) { task_state[field * params.envs + env] = value; }
fn start(field: u32) -> f32 { return starts[field * params.envs + env]; }

// Which way the root faces on the ground, rad.
fn heading() -> f32 {
    let w = start(3u);
    let x = start(4u);
    let y = start(5u);
    let z = start(6u);
    return atan2(2.0 * (x * y + w * z), 1.0 - 2.0 * (y * y + z * z));
}

@compute @workgroup_size(64)
fn place_target(@builtin(global_invocation_id) id: vec3u) {
    env = id.x;
    if (env >= params.envs) { return; }
    if (mask[env] == 0u) { return; }
    let bits = random4(params.seed, params.first + env, params.step_counter, STREAM);
    let more = random4(params.seed, params.first + env, params.step_counter, STREAM + 1u);
    let near = uniform01(bits.x) < params.near_share;
    let spread = 2.0 * uniform01(bits.y) - 1.0;
    let bearing = heading() + spread * select(PI, params.near_bearing, near);
    let range = select(vec2f(params.least, params.most), vec2f(params.near_least, params.near_most), near);
    let distance = mix(range.x, range.y, uniform01(bits.z));
    let way = vec2f(cos(bearing), sin(bearing));
    let yaw = 2.0 * PI * uniform01(bits.w);
    let turn = 2.0 * uniform01(more.x) - 1.0;
    let facing = bearing + PI * sign(turn) * pow(abs(turn), params.facing_power);
    let q = params.target_q;
    assign(q, start(0u) + distance * way.x);
    assign(q + 1u, start(1u) + distance * way.y);
    assign(q + 2u, params.height);
    assign(q + 3u, cos(0.5 * yaw));
    assign(q + 4u, 0.0);
    assign(q + 5u, 0.0);
    assign(q + 6u, sin(0.5 * yaw));
    for (var k = 0u; k < 6u; k++) { assign(params.nq + params.target_v + k, 0.0); }
    for (var k = 0u; k < PUNCH_STATE; k++) { carry(k, 0.0); }
    carry(FACING, cos(facing));
    carry(FACING + 1u, sin(facing));
    carry(MOVING, way.x);
    carry(MOVING + 1u, way.y);
}
