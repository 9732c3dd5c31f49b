// Generalised advantage estimation (Schulman et al. 2016, equation 16) over one rollout.
// One invocation an environment, backwards in time. An end cuts the sum; the ends of `bootstrap`
// go on with the value of the last real state, the others with nothing.
//
// reward        [steps][envs]
// termination         [steps][envs]
// value         [steps][envs]   the critic's output, normalised
// next_value    [envs]          of the state after the last step
// final_value   [steps][envs]   of the last real state of an episode that ended there, or [envs] if
//                               `final_steps` is 1: no environment has two bootstrapped ends then
// scale         [2]             mean and deviation that undo the critic's normalisation
// advantage     [steps][envs]   in units of reward
// target_value  [steps][envs]   in units of reward: what the critic shall learn

#import termination

struct Params {
    envs: u32,
    steps: u32,
    gamma: f32,
    lambda: f32,
    // Bits, 1 << end.
    bootstrap: u32,
    final_steps: u32,
}

@group(0) @binding(0) var<storage, read> reward: array<f32>;
@group(0) @binding(1) var<storage, read> termination: array<u32>;
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
        let end = termination[at];
        if (end != RUNNING) {
            let last = final_value[select(at, env, params.final_steps == 1u)] * scale[1] + scale[0];
            after = select(0.0, last, (params.bootstrap >> end & 1u) == 1u);
            sum = 0.0;
        }
        let now = value[at] * scale[1] + scale[0];
        sum = reward[at] + params.gamma * after - now + params.gamma * params.lambda * sum;
        advantage[at] = sum;
        target_value[at] = sum + now;
        after = now;
    }
}
