// Whom bouts are against (src/kernels/self_play/opponent_table.rs). The importing shader binds `opponents`.
//
// Bounds of loops are read from here, not from the uniform: lavapipe compiles a shader anew for every launch in which a
// uniform decides how often a loop runs.

#import bout_rows

struct OpponentTable {
    envs: u32,
    stats: u32,         // sums of statistics of a row
    count: u32,         // opponents
    scripted: u32,      // how many of them, the first, follow a script; the others are policies
    words: array<u32>,  // the numbers [count] of all, then their lots [count]
}

// The index of an opponent by its number: the newest's, if it has left.
fn opponent_index(number: u32) -> u32 {
    for (var index = 0u; index < opponents.count; index++) {
        if (opponents.words[index] == number) { return index; }
    }
    return opponents.count - 1u;
}
