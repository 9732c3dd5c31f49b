// Puts what the learner does and what the policies of its opponents draw from their Gaussians where the environments
// want it. One invocation a number of an action; rows of scripts are left alone.
//
// own         [envs]    the learner's row of an environment
// place       [envs]    row of a policy; what is not below SCRIPTED is none
// blocks      [..]      the policy of a block of rows
// learner     [envs][action] from the index `at` on
// mean        [..][action]   of the policies
// parameters  [policies][parameters], logarithms of standard deviations [action] from `log_std` on
// action      [2 envs][action]

#import action_noise
#import bout_rows

struct Params {
    envs: u32,
    action: u32,
    at: u32,
    block: u32,         // rows of a block
    parameters: u32,    // of a policy
    log_std: u32,
    first: u32,         // number of the first environment in the whole batch
    seed: u32,
    step_counter: u32,
}

@group(0) @binding(0) var<storage, read> own: array<u32>;
@group(0) @binding(1) var<storage, read> place: array<u32>;
@group(0) @binding(2) var<storage, read> blocks: array<u32>;
@group(0) @binding(3) var<storage, read> learner: array<f32>;
@group(0) @binding(4) var<storage, read> mean: array<f32>;
@group(0) @binding(5) var<storage, read> parameters: array<f32>;
@group(0) @binding(6) var<storage, read_write> action: array<f32>;
@group(0) @binding(7) var<uniform> params: Params;

@compute @workgroup_size(4, 64)
fn bout_actions(@builtin(global_invocation_id) id: vec3u) {
    let i = id.x;
    let env = id.y;
    if (i >= params.action || env >= params.envs) { return; }
    let row = own[env];
    action[row * params.action + i] = learner[params.at + env * params.action + i];
    let slot = place[env];
    if (slot >= SCRIPTED) { return; }
    let policy = blocks[slot / params.block];
    let log_std = parameters[policy * params.parameters + params.log_std + i];
    let noise = action_noise(params.seed, params.first + env, params.step_counter, i);
    action[(row ^ 1u) * params.action + i] = mean[slot * params.action + i] + exp(log_std) * noise;
}
