// Pushes a body at random times: once in every `interval` steps, in one of its first `jitter` + 1, in a random
// horizontal direction and by a random force. One invocation an environment.
//
// external_forces  [bodies * 6][envs], see `smooth_dynamics`: the force on `body`, none in all other steps

#import rng

struct Params {
    envs: u32,
    first: u32,
    seed: u32,
    step_counter: u32,
    interval: u32,
    jitter: u32,
    body: u32,
    min_force: f32, // N
    max_force: f32,
}

@group(0) @binding(0) var<storage, read_write> external_forces: array<f32>;
@group(0) @binding(1) var<uniform> params: Params;

const STREAM = 0x50555348u;
const TAU = 6.2831855;

fn push(env: u32) -> vec2f {
    let bits = random4(params.seed, params.first + env, params.step_counter / params.interval, STREAM);
    if (params.step_counter % params.interval != index_below(bits.x, params.jitter + 1u)) { return vec2f(0.0); }
    let angle = TAU * uniform01(bits.y);
    let force = params.min_force + (params.max_force - params.min_force) * uniform01(bits.z);
    return force * vec2f(cos(angle), sin(angle));
}

@compute @workgroup_size(64)
fn random_pushes(@builtin(global_invocation_id) id: vec3u) {
    let env = id.x;
    if (env >= params.envs) { return; }
    let force = push(env);
    let at = (6u * params.body + 3u) * params.envs + env;
    external_forces[at] = force.x;
    external_forces[at + params.envs] = force.y;
}
