// Nearest candidate of every query within a chunk of the database, by comparing with every row.
// The form for software adapters: queries across lanes, eight an invocation, and the database
// row the same for all lanes. An invocation stays far below the 65,535 loop iterations after
// which lavapipe silently stops looping. Pieces are joined by search_merge.
//
// rows       [candidates][QUADS] of vec4   normalised features, padded with zeros
// queries    [count][QUADS] of vec4
// distance   [chunks][count]   squared, of the best row of the chunk
// index      [chunks][count]   that row, the lowest of equals

#import layout
#import distance

struct Params {
    count: u32,
    candidates: u32,
    chunk: u32,
}

@group(0) @binding(0) var<storage, read> rows: array<vec4f>;
@group(0) @binding(1) var<storage, read> queries: array<vec4f>;
@group(0) @binding(2) var<storage, read_write> distance: array<f32>;
@group(0) @binding(3) var<storage, read_write> index: array<u32>;
@group(0) @binding(4) var<uniform> params: Params;

const LANES = 8u;
const QUERIES = 8u; // an invocation

fn row(at: u32) -> Feature {
    let i = at * QUADS;
    return Feature(rows[i], rows[i + 1u], rows[i + 2u], rows[i + 3u], rows[i + 4u], rows[i + 5u], rows[i + 6u]);
}

// Queries past the end repeat the last one and are not written.
fn load(at: u32) -> Feature {
    let i = min(at, params.count - 1u) * QUADS;
    return Feature(queries[i], queries[i + 1u], queries[i + 2u], queries[i + 3u], queries[i + 4u], queries[i + 5u], queries[i + 6u]);
}

fn write(chunk: u32, at: u32, best: f32, found: u32) {
    if (at < params.count) {
        distance[chunk * params.count + at] = best;
        index[chunk * params.count + at] = found;
    }
}

@compute @workgroup_size(8)
fn search_wide(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let first = group.x * LANES * QUERIES + local.x;
    let begin = group.y * params.chunk;
    let end = min(begin + params.chunk, params.candidates);
    let q0 = load(first + 0u * LANES);
    let q1 = load(first + 1u * LANES);
    let q2 = load(first + 2u * LANES);
    let q3 = load(first + 3u * LANES);
    let q4 = load(first + 4u * LANES);
    let q5 = load(first + 5u * LANES);
    let q6 = load(first + 6u * LANES);
    let q7 = load(first + 7u * LANES);
    var best0 = 3.4e38;
    var best1 = 3.4e38;
    var best2 = 3.4e38;
    var best3 = 3.4e38;
    var best4 = 3.4e38;
    var best5 = 3.4e38;
    var best6 = 3.4e38;
    var best7 = 3.4e38;
    var found0 = begin;
    var found1 = begin;
    var found2 = begin;
    var found3 = begin;
    var found4 = begin;
    var found5 = begin;
    var found6 = begin;
    var found7 = begin;
    for (var at = begin; at < end; at += 2u) {
        // An odd last row is compared with itself again: a tie, which changes nothing.
        let next = min(at + 1u, end - 1u);
        let a = row(at);
        let b = row(next);
        let a0 = squared(a, q0);
        if (a0 < best0) { best0 = a0; found0 = at; }
        let b0 = squared(b, q0);
        if (b0 < best0) { best0 = b0; found0 = next; }
        let a1 = squared(a, q1);
        if (a1 < best1) { best1 = a1; found1 = at; }
        let b1 = squared(b, q1);
        if (b1 < best1) { best1 = b1; found1 = next; }
        let a2 = squared(a, q2);
        if (a2 < best2) { best2 = a2; found2 = at; }
        let b2 = squared(b, q2);
        if (b2 < best2) { best2 = b2; found2 = next; }
        let a3 = squared(a, q3);
        if (a3 < best3) { best3 = a3; found3 = at; }
        let b3 = squared(b, q3);
        if (b3 < best3) { best3 = b3; found3 = next; }
        let a4 = squared(a, q4);
        if (a4 < best4) { best4 = a4; found4 = at; }
        let b4 = squared(b, q4);
        if (b4 < best4) { best4 = b4; found4 = next; }
        let a5 = squared(a, q5);
        if (a5 < best5) { best5 = a5; found5 = at; }
        let b5 = squared(b, q5);
        if (b5 < best5) { best5 = b5; found5 = next; }
        let a6 = squared(a, q6);
        if (a6 < best6) { best6 = a6; found6 = at; }
        let b6 = squared(b, q6);
        if (b6 < best6) { best6 = b6; found6 = next; }
        let a7 = squared(a, q7);
        if (a7 < best7) { best7 = a7; found7 = at; }
        let b7 = squared(b, q7);
        if (b7 < best7) { best7 = b7; found7 = next; }
    }
    write(group.y, first + 0u * LANES, best0, found0);
    write(group.y, first + 1u * LANES, best1, found1);
    write(group.y, first + 2u * LANES, best2, found2);
    write(group.y, first + 3u * LANES, best3, found3);
    write(group.y, first + 4u * LANES, best4, found4);
    write(group.y, first + 5u * LANES, best5, found5);
    write(group.y, first + 6u * LANES, best6, found6);
    write(group.y, first + 7u * LANES, best7, found7);
}
