// Stands two fighters on opposite sides of an arena's centre, turned any way, where an episode begins. One
// invocation an environment.
//
// mask        [envs]: not 0 where an episode begins
// starts      [nq + nv][envs]: the positions of one fighter and the other, then their velocities; the free joint of
//             the root comes first
// task_state  [..][envs], see `boxing`: takes the start of a bout

#import rng
#import boxing

struct Params {
    envs: u32,
    first: u32,
    seed: u32,
    step_counter: u32,
    positions: u32, // of a fighter
    dofs: u32,      // of a fighter
    arena: f32,     // m, half its width
    least: f32,     // m from the centre
    most: f32,
}

@group(0) @binding(0) var<storage, read_write> mask: array<u32>;
@group(0) @binding(1) var<storage, read_write> starts: array<f32>;
@group(0) @binding(2) var<storage, read_write> task_state: array<f32>;
@group(0) @binding(3) var<uniform> params: Params;

const STREAM = 0x424f5854u;
const PI = 3.1415927;
const MARGIN = 0.25; // m, of starts from the border

var<private> env: u32;

fn start(field: u32) -> f32 { return starts[field * params.envs + env]; }
fn assign(field: u32, value: f32) { starts[field * params.envs + env] = value; }
fn carry(field: u32, value: f32) { task_state[field * params.envs + env] = value; }

// Turns a fighter about the vertical by `yaw` rad, and stands it `at` a point of the ground.
fn place(fighter: u32, at: vec2f, yaw: f32) {
    let q = fighter * params.positions;
    let v = 2u * params.positions + fighter * params.dofs;
    let way = vec2f(cos(yaw), sin(yaw));
    let half = vec2f(cos(0.5 * yaw), sin(0.5 * yaw));
    let rotation = vec4f(start(q + 3u), start(q + 4u), start(q + 5u), start(q + 6u));
    let speed = vec2f(start(v), start(v + 1u));
    assign(q, at.x);
    assign(q + 1u, at.y);
    assign(q + 3u, half.x * rotation.x - half.y * rotation.w);
    assign(q + 4u, half.x * rotation.y - half.y * rotation.z);
    assign(q + 5u, half.x * rotation.z + half.y * rotation.y);
    assign(q + 6u, half.x * rotation.w + half.y * rotation.x);
    assign(v, way.x * speed.x - way.y * speed.y);
    assign(v + 1u, way.x * speed.y + way.y * speed.x);
}

@compute @workgroup_size(64)
fn place_fighters(@builtin(global_invocation_id) id: vec3u) {
    env = id.x;
    if (env >= params.envs) { return; }
    let begins = mask[env] != 0u;
    let joints = params.dofs - ROOT_DOFS;
    // Bounded by a buffer, too: see `end_episode`.
    for (var k = 0u; k < select(0u, 2u * joints, begins); k++) {
        let fighter = k / joints;
        let speed = 2u * params.positions + fighter * params.dofs + ROOT_DOFS + k % joints;
        carry(JOINT_SPEEDS + k, start(speed));
    }
    if (!begins) { return; }
    for (var k = 0u; k < JOINT_SPEEDS; k++) { carry(k, 0.0); }
    let bits = random4(params.seed, params.first + env, params.step_counter, STREAM);
    let more = random4(params.seed, params.first + env, params.step_counter, STREAM + 1u);
    let bearing = 2.0 * PI * uniform01(bits.x);
    let way = vec2f(cos(bearing), sin(bearing));
    let edge = vec2f(params.arena - MARGIN);
    let red = mix(params.least, params.most, uniform01(bits.y)) * way;
    let blue = -mix(params.least, params.most, uniform01(bits.z)) * way;
    place(0u, clamp(red, -edge, edge), 2.0 * PI * uniform01(bits.w));
    place(1u, clamp(blue, -edge, edge), 2.0 * PI * uniform01(more.x));
}
