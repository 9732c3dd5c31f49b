// Draws targets for the drives: normal, of a given std, about zero. One row of workgroups
// a target, one invocation an environment.
//
// targets  [driven][envs], rad

#import rng

struct Params {
    envs: u32,
    driven: u32,
    action_std: f32, // rad
    seed: u32,
    step_counter: u32,
    stream: u32,
}

@group(0) @binding(0) var<storage, read_write> targets: array<f32>;
@group(0) @binding(1) var<uniform> params: Params;

@compute @workgroup_size(64)
fn random_targets(@builtin(global_invocation_id) id: vec3u) {
    let env = id.x;
    let index = id.y;
    if (env >= params.envs || index >= params.driven) { return; }
    let bits = random4(params.seed, env, params.step_counter, params.stream + index);
    targets[index * params.envs + env] = params.action_std * gaussian(bits);
}
