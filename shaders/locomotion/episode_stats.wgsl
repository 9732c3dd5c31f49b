// Sums what the episodes ended since the last tally brought, and starts the sums anew.
// One workgroup; each invocation takes every 64th environment, then a tree joins them.
//
// state_f32  [STATE_F32_FIELDS][envs]
// state_u32  [STATE_U32_FIELDS][envs]
// sums       [6]   episodes, successes, collisions, truncations, steps, summed return

#import locomotion_layout

struct Params {
    envs: u32,
}

@group(0) @binding(0) var<storage, read_write> state_f32: array<f32>;
@group(0) @binding(1) var<storage, read_write> state_u32: array<u32>;
@group(0) @binding(2) var<storage, read_write> sums: array<f32>;
@group(0) @binding(3) var<uniform> params: Params;

const LANES = 64u;

const COUNTS = 5u; // EPISODES to LENGTHS

var<workgroup> counts: array<array<u32, 5>, 64>;
var<workgroup> returns: array<f32, 64>;

@compute @workgroup_size(64)
fn episode_stats(@builtin(local_invocation_id) id: vec3u) {
    let lane = id.x;
    let envs = params.envs;
    var count = array<u32, 5>();
    var total = 0.0;
    for (var env = lane; env < envs; env += LANES) {
        for (var i = 0u; i < COUNTS; i++) {
            count[i] += state_u32[(EPISODES + i) * envs + env];
            state_u32[(EPISODES + i) * envs + env] = 0u;
        }
        total += state_f32[RETURNS * envs + env];
        state_f32[RETURNS * envs + env] = 0.0;
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
