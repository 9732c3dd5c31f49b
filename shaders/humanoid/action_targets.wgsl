// Targets of the drives from actions. One row of workgroups a drive, one invocation an environment.
//
// action   [envs][driven], from `at` on; an environment's agents are side by side, as their drives are
// scale    [2][driven]: offset and scale, rad
// targets  [driven][envs], rad

struct Params {
    envs: u32,
    driven: u32,
    at: u32,
}

@group(0) @binding(0) var<storage, read_write> action: array<f32>;
@group(0) @binding(1) var<storage, read_write> scale: array<f32>;
@group(0) @binding(2) var<storage, read_write> targets: array<f32>;
@group(0) @binding(3) var<uniform> params: Params;

@compute @workgroup_size(64)
fn action_targets(@builtin(global_invocation_id) id: vec3u) {
    let env = id.x;
    let drive = id.y;
    if (env >= params.envs) { return; }
    let within = min(max(action[params.at + env * params.driven + drive], -1.0), 1.0);
    targets[drive * params.envs + env] = scale[drive] + scale[params.driven + drive] * within;
}
