// Counts the bouts that have ended by how the learner's did, and draws who plays whom in those that begin. One
// invocation an environment.
//
// opponents    see bouts
// termination  [2 envs]
// now, before  [stats][2 envs]   sums of the rows' episodes that have ended, now and a step ago
// own          [envs]            the learner's row
// opponent     [envs]            number of the opponent
// sums         [stats][envs]     of the learner's episodes
// tallies      [opponents][2]    bouts against each; halves of them that the learner won, two for a win and one for a
//                                draw. Bouts against opponents that have left are not counted

#import bouts
#import rng
#import termination

struct Params {
    successes: u32,     // index of successes among the statistics
    first: u32,         // number of the first environment in the whole batch
    seed: u32,
    step_counter: u32,
}

@group(0) @binding(0) var<storage, read> opponents: OpponentTable;
@group(0) @binding(1) var<storage, read> termination: array<u32>;
@group(0) @binding(2) var<storage, read> now: array<f32>;
@group(0) @binding(3) var<storage, read> before: array<f32>;
@group(0) @binding(4) var<storage, read_write> own: array<u32>;
@group(0) @binding(5) var<storage, read_write> opponent: array<u32>;
@group(0) @binding(6) var<storage, read_write> sums: array<f32>;
@group(0) @binding(7) var<storage, read_write> tallies: array<atomic<u32>>;
@group(0) @binding(8) var<uniform> params: Params;

const BOUTS = 0x424f5554u; // random stream of who meets whom

fn gained(stat: u32, row: u32) -> f32 {
    let at = stat * 2u * opponents.envs + row;
    return now[at] - before[at];
}

// The index of the opponent that random bits draw: the first whose lot is above them.
fn drawn(bits: u32) -> u32 {
    for (var index = 0u; index + 1u < opponents.count; index++) {
        if (bits >> 8u < opponents.words[opponents.count + index]) { return index; }
    }
    return opponents.count - 1u;
}

@compute @workgroup_size(64)
fn end_bouts(@builtin(global_invocation_id) id: vec3u) {
    let env = id.x;
    if (env >= opponents.envs) { return; }
    let row = own[env];
    if (termination[row] == RUNNING) { return; }
    for (var stat = 0u; stat < opponents.stats; stat++) {
        sums[stat * opponents.envs + env] += gained(stat, row);
    }
    let index = opponent_index(opponent[env]);
    if (opponents.words[index] == opponent[env]) {
        let halves = 1.0 + gained(params.successes, row) - gained(params.successes, row ^ 1u);
        atomicAdd(&tallies[2u * index], 1u);
        atomicAdd(&tallies[2u * index + 1u], u32(clamp(halves, 0.0, 2.0)));
    }
    let bits = random4(params.seed, params.first + env, params.step_counter, BOUTS);
    own[env] = 2u * env + index_below(bits.x, 2u);
    opponent[env] = opponents.words[drawn(bits.y)];
}
