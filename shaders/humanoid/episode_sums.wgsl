// Sums fields over all environments, and starts them anew. One workgroup a field; each invocation takes every
// 64th environment, then a tree joins them.
//
// values  [fields][envs], from the field `start` on; zero afterwards
// sums    [fields]

struct Params {
    envs: u32,
    start: u32,
    fields: u32,
}

@group(0) @binding(0) var<storage, read_write> values: array<f32>;
@group(0) @binding(1) var<storage, read_write> sums: array<f32>;
@group(0) @binding(2) var<uniform> params: Params;

const LANES = 64u;

var<workgroup> partials: array<f32, 64>;

@compute @workgroup_size(64)
fn episode_sums(@builtin(local_invocation_id) id: vec3u, @builtin(workgroup_id) group: vec3u) {
    let lane = id.x;
    if (group.x >= params.fields) { return; }
    let row = (params.start + group.x) * params.envs;
    var total = 0.0;
    for (var env = lane; env < params.envs; env += LANES) {
        total += values[row + env];
        values[row + env] = 0.0;
    }
    partials[lane] = total;
    workgroupBarrier();
    for (var half = LANES / 2u; half > 0u; half /= 2u) {
        if (lane < half) { partials[lane] += partials[lane + half]; }
        workgroupBarrier();
    }
    if (lane == 0u) { sums[group.x] = partials[0]; }
}
