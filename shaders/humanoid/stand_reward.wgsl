// Reward of a step of the task `stand`. One invocation an environment.
//
// Bounds of loops depend on a buffer, too: lavapipe compiles a shader anew for every launch in which the uniform
// alone decides how often a loop runs.
//
// state     [nq + nv][envs], after the step
// poses     [bodies * 7][envs], of that state
// reward    [envs], from `at` on
// measures  [1][envs]: the uprightness

struct Params {
    envs: u32,
    at: u32,
    nq: u32,
    nv: u32,
    torso: u32,
    alive_reward: f32,
    upright_reward: f32,
    stillness_reward: f32,
}

@group(0) @binding(0) var<storage, read_write> state: array<f32>;
@group(0) @binding(1) var<storage, read_write> poses: array<f32>;
@group(0) @binding(2) var<storage, read_write> reward: array<f32>;
@group(0) @binding(3) var<storage, read_write> measures: array<f32>;
@group(0) @binding(4) var<uniform> params: Params;

// How far the torso's up axis points up: 1 upright, -1 upside down.
fn uprightness(env: u32) -> f32 {
    let at = (7u * params.torso + 3u) * params.envs + env;
    let x = poses[at];
    let y = poses[at + params.envs];
    return 1.0 - 2.0 * (x * x + y * y);
}

// How little the joints move: 1 for those that stand still, falling with their mean square speed.
fn stillness(env: u32) -> f32 {
    let bound = select(params.nv, 0u, state[env] > 1e30);
    var sum = 0.0;
    for (var dof = 6u; dof < bound; dof++) {
        let speed = state[(params.nq + dof) * params.envs + env];
        sum += speed * speed;
    }
    return exp(-0.1 * sum / f32(params.nv - 6u));
}

@compute @workgroup_size(64)
fn stand_reward(@builtin(global_invocation_id) id: vec3u) {
    let env = id.x;
    if (env >= params.envs) { return; }
    let upright = uprightness(env);
    measures[env] = upright;
    reward[params.at + env] =
        params.alive_reward + params.upright_reward * upright + params.stillness_reward * stillness(env);
}
