// Puts the rows of every policy one behind another, in the order of their environments, so that a policy has blocks of
// rows of its own. One workgroup, of which each invocation counts a part of the environments.
//
// opponents  see bouts
// opponent   [envs]    number of the opponent
// place      [envs]    the row of a policy; a script's index, SCRIPTED added
// slots      [blocks][block]   the environment of a row, or NOBODY where a block is not full
// blocks     [blocks]  the policy of a block, from 0, or NOBODY

#import bouts

struct Params {
    block: u32,   // rows of a block
    blocks: u32,
}

@group(0) @binding(0) var<storage, read> opponents: OpponentTable;
@group(0) @binding(1) var<storage, read> opponent: array<u32>;
@group(0) @binding(2) var<storage, read_write> place: array<u32>;
@group(0) @binding(3) var<storage, read_write> slots: array<u32>;
@group(0) @binding(4) var<storage, read_write> blocks: array<u32>;
@group(0) @binding(5) var<uniform> params: Params;

const LANES = 32u;
const MAX_POLICIES = 64u;

// Rows of each policy in the part of each invocation; then those in the parts before it.
var<workgroup> counts: array<u32, 2048>;
var<workgroup> totals: array<u32, 64>;
// The first block of each policy, and the first of nobody.
var<workgroup> starts: array<u32, 65>;

@compute @workgroup_size(LANES)
fn group_bouts(@builtin(local_invocation_index) lane: u32) {
    let policies = opponents.count - opponents.scripted;
    let part = (opponents.envs + LANES - 1u) / LANES;
    let first = min(lane * part, opponents.envs);
    let end = min(first + part, opponents.envs);
    for (var policy = 0u; policy < policies; policy++) { counts[policy * LANES + lane] = 0u; }
    for (var env = first; env < end; env++) {
        let index = opponent_index(opponent[env]);
        place[env] = SCRIPTED + index;
        if (index >= opponents.scripted) { counts[(index - opponents.scripted) * LANES + lane] += 1u; }
    }
    workgroupBarrier();
    for (var policy = lane; policy < policies; policy += LANES) {
        var sum = 0u;
        for (var other = 0u; other < LANES; other++) {
            let own = counts[policy * LANES + other];
            counts[policy * LANES + other] = sum;
            sum += own;
        }
        totals[policy] = sum;
    }
    workgroupBarrier();
    if (lane == 0u) {
        starts[0] = 0u;
        for (var policy = 0u; policy < policies; policy++) {
            starts[policy + 1u] = starts[policy] + (totals[policy] + params.block - 1u) / params.block;
        }
    }
    workgroupBarrier();
    for (var policy = lane; policy < policies; policy += LANES) {
        for (var block = starts[policy]; block < starts[policy + 1u]; block++) { blocks[block] = policy; }
        for (var slot = starts[policy] * params.block + totals[policy]; slot < starts[policy + 1u] * params.block; slot++) {
            slots[slot] = NOBODY;
        }
    }
    for (var block = starts[policies] + lane; block < params.blocks; block += LANES) {
        blocks[block] = NOBODY;
        for (var row = 0u; row < params.block; row++) { slots[block * params.block + row] = NOBODY; }
    }
    for (var env = first; env < end; env++) {
        let index = place[env] - SCRIPTED;
        if (index < opponents.scripted) { continue; }
        let policy = index - opponents.scripted;
        let slot = starts[policy] * params.block + counts[policy * LANES + lane];
        counts[policy * LANES + lane] += 1u;
        slots[slot] = env;
        place[env] = slot;
    }
}
