// Sums what the episodes ended since the last tally brought, and starts the sums anew.
// One workgroup; each invocation takes every 64th environment, then a tree joins them.
//
// real   [REALS][envs]
// whole  [WHOLES][envs]
// sums   [4]   episodes, successes, steps, summed return

#import layout

struct Params {
    envs: u32,
}

@group(0) @binding(0) var<storage, read_write> real: array<f32>;
@group(0) @binding(1) var<storage, read_write> whole: array<u32>;
@group(0) @binding(2) var<storage, read_write> sums: array<f32>;
@group(0) @binding(3) var<uniform> params: Params;

const LANES = 64u;

var<workgroup> counts: array<vec3u, 64>;
var<workgroup> returns: array<f32, 64>;

@compute @workgroup_size(64)
fn tally(@builtin(local_invocation_id) id: vec3u) {
    let lane = id.x;
    let envs = params.envs;
    var count = vec3u(0u);
    var total = 0.0;
    for (var env = lane; env < envs; env += LANES) {
        count += vec3u(whole[EPISODES * envs + env], whole[SUCCESSES * envs + env], whole[LENGTHS * envs + env]);
        total += real[RETURNS * envs + env];
        whole[EPISODES * envs + env] = 0u;
        whole[SUCCESSES * envs + env] = 0u;
        whole[LENGTHS * envs + env] = 0u;
        real[RETURNS * envs + env] = 0.0;
    }
    counts[lane] = count;
    returns[lane] = total;
    workgroupBarrier();
    for (var half = LANES / 2u; half > 0u; half /= 2u) {
        if (lane < half) {
            counts[lane] += counts[lane + half];
            returns[lane] += returns[lane + half];
        }
        workgroupBarrier();
    }
    if (lane == 0u) {
        sums[0] = f32(counts[0].x);
        sums[1] = f32(counts[0].y);
        sums[2] = f32(counts[0].z);
        sums[3] = returns[0];
    }
}
