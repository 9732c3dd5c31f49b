// Sums what the episodes ended since the last tally brought, and starts the sums anew.
// One workgroup; each invocation takes every 64th environment, then a tree joins them.
//
// real   [REALS][envs]
// whole  [WHOLES][envs]
// sums   [6]   episodes, successes, collisions, truncations, steps, summed return

#import layout

struct Params {
    envs: u32,
}

@group(0) @binding(0) var<storage, read_write> real: array<f32>;
@group(0) @binding(1) var<storage, read_write> whole: array<u32>;
@group(0) @binding(2) var<storage, read_write> sums: array<f32>;
@group(0) @binding(3) var<uniform> params: Params;

const LANES = 64u;

const COUNTS = 5u; // EPISODES to LENGTHS

var<workgroup> counts: array<array<u32, 5>, 64>;
var<workgroup> returns: array<f32, 64>;

@compute @workgroup_size(64)
fn tally(@builtin(local_invocation_id) id: vec3u) {
    let lane = id.x;
    let envs = params.envs;
    var count = array<u32, 5>();
    var total = 0.0;
    for (var env = lane; env < envs; env += LANES) {
        for (var i = 0u; i < COUNTS; i++) {
            count[i] += whole[(EPISODES + i) * envs + env];
            whole[(EPISODES + i) * envs + env] = 0u;
        }
        total += real[RETURNS * envs + env];
        real[RETURNS * envs + env] = 0.0;
    }
    counts[lane] = count;
    returns[lane] = total;
    workgroupBarrier();
    for (var half = LANES / 2u; half > 0u; half /= 2u) {
        if (lane < half) {
            for (var i = 0u; i < COUNTS; i++) { counts[lane][i] += counts[lane + half][i]; }
            returns[lane] += returns[lane + half];
        }
        workgroupBarrier();
    }
    if (lane == 0u) {
        for (var i = 0u; i < COUNTS; i++) { sums[i] = f32(counts[0][i]); }
        sums[COUNTS] = returns[0];
    }
}
