// Generalised advantage estimation (Schulman et al. 2016, equation 16) over one rollout.
// One invocation an environment, backwards in time. A reached target ends the sum; a
// truncation bootstraps with the value of the last real state and cuts the sum there.
//
// reward        [steps][envs]
// ended         [steps][envs]   RUNNING, REACHED or TRUNCATED
// value         [steps][envs]   the critic's output, normalised
// next_value    [envs]          of the state after the last step
// final_value   [envs]          of the last real state of the episode truncated in this rollout
// scale         [2]             mean and deviation that undo the critic's normalisation
// advantage     [steps][envs]   in units of reward
// target_value  [steps][envs]   in units of reward: what the critic shall learn

#import layout

struct Params {
    envs: u32,
    steps: u32,
    gamma: f32,
    lambda: f32,
}

@group(0) @binding(0) var<storage, read> reward: array<f32>;
@group(0) @binding(1) var<storage, read> ended: array<u32>;
@group(0) @binding(2) var<storage, read> value: array<f32>;
@group(0) @binding(3) var<storage, read> next_value: array<f32>;
@group(0) @binding(4) var<storage, read> final_value: array<f32>;
@group(0) @binding(5) var<storage, read> scale: array<f32>;
@group(0) @binding(6) var<storage, read_write> advantage: array<f32>;
@group(0) @binding(7) var<storage, read_write> target_value: array<f32>;
@group(0) @binding(8) var<uniform> params: Params;

@compute @workgroup_size(64)
fn gae(@builtin(global_invocation_id) id: vec3u) {
    let env = id.x;
    if (env >= params.envs) { return; }
    var after = next_value[env] * scale[1] + scale[0];
    var sum = 0.0;
    for (var back = 0u; back < params.steps; back++) {
        let at = (params.steps - 1u - back) * params.envs + env;
        let end = ended[at];
        if (end == REACHED) {
            after = 0.0;
        } else if (end == TRUNCATED) {
            after = final_value[env] * scale[1] + scale[0];
        }
        if (end != RUNNING) { sum = 0.0; }
        let now = value[at] * scale[1] + scale[0];
        sum = reward[at] + params.gamma * after - now + params.gamma * params.lambda * sum;
        advantage[at] = sum;
        target_value[at] = sum + now;
        after = now;
    }
}
