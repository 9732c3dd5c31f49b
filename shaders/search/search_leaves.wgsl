// The nearest candidate of every query among what is known and the leaves that search_prune
// left, exactly; of equal distances the lowest. Eight invocations a query, each with two rows
// of every leaf; search_argmin then picks the best of the eight.
//
// A row is first compared in bytes, a quarter of what must be fetched; only if that leaves it in
// question in floats. Bytes are the numbers clipped to [-range, range] and rounded; clipping moves no two
// points further apart, and `quantisation_error` is the distance that rounding moves a row at most.
//
// Lavapipe runs through the body of every loop and branch once, even if no invocation wants it: so
// what is expensive is in loops that mostly do it, one after the other, and not inside each other. It
// also silently stops an invocation after 65,535 iterations; a launch looks at a bounded run of leaves.
//
// rows              [leaves * LEAF][QUADS] of vec4   in the index's order; the last number is the candidate
// quantised_rows    [leaves * LEAF][QUADS]           four bytes a word
// queries           [count][QUADS] of vec4
// query_projection  [PROJECTION_LEN][count]          see search_seed
// leaf_mask         [words][count]                   see search_prune
// distance, candidates  [LANES][count]               the best each lane knows; distances are squares

#import locomotion_layout
#import feature
#import search_index

struct Params {
    count: u32,
    // The leaves searched: first .. last - 1.
    first: u32,
    last: u32,
    range: f32,
    quantisation_error: f32,
}

@group(0) @binding(0) var<storage, read> rows: array<vec4f>;
@group(0) @binding(1) var<storage, read> quantised_rows: array<u32>;
@group(0) @binding(2) var<storage, read> queries: array<vec4f>;
@group(0) @binding(3) var<storage, read> query_projection: array<f32>;
@group(0) @binding(4) var<storage, read> leaf_mask: array<u32>;
@group(0) @binding(5) var<storage, read_write> distance: array<f32>;
@group(0) @binding(6) var<storage, read_write> candidates: array<u32>;
@group(0) @binding(7) var<uniform> params: Params;

const LIST = 16u; // rows to be compared exactly, at most

fn load_query(at: u32) -> Feature {
    let i = at * QUADS;
    let g = vec4f(queries[i + 6u].xyz, 0.0);
    return Feature(queries[i], queries[i + 1u], queries[i + 2u], queries[i + 3u], queries[i + 4u], queries[i + 5u], g);
}

// From [-range, range] to [0, 1], where bytes are.
fn clip(v: vec4f) -> vec4f {
    return clamp(fma(v, vec4f(0.5 / params.range), vec4f(0.5)), vec4f(0.0), vec4f(1.0));
}

fn clip_all(q: Feature) -> Feature {
    return Feature(clip(q.a), clip(q.b), clip(q.c), clip(q.d), clip(q.e), clip(q.f), vec4f(clip(q.g).xyz, 0.0));
}

fn coarse_distance(row: u32, q: Feature) -> f32 {
    let i = row * QUADS;
    return squared(Feature(
        unpack4x8unorm(quantised_rows[i]), unpack4x8unorm(quantised_rows[i + 1u]), unpack4x8unorm(quantised_rows[i + 2u]),
        unpack4x8unorm(quantised_rows[i + 3u]), unpack4x8unorm(quantised_rows[i + 4u]), unpack4x8unorm(quantised_rows[i + 5u]),
        unpack4x8unorm(quantised_rows[i + 6u]),
    ), q);
}

// Square of the distance in bytes beyond which nothing is within `limit`.
fn coarse_limit(limit: f32) -> f32 {
    let length = (sqrt(limit) * RELATIVE + params.quantisation_error) * 0.5 / params.range;
    return length * length;
}

@compute @workgroup_size(64)
fn search_leaves(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let invocation = id.y * groups.x * 64u + id.x;
    let at = invocation / LANES;
    let lane = invocation % LANES;
    if (at >= params.count) { return; }
    let mine = lane * params.count + at;
    let q = load_query(at);
    let clipped = clip_all(q);
    let slack = query_projection[12u * params.count + at];
    var best = distance[mine];
    var candidate = candidates[mine];
    var list: array<u32, LIST>;
    var leaves = 0u; // bits of the leaves to search, from `word` on
    var word = params.first;
    var next = params.first;
    while (leaves != 0u || next < params.last) {
        let limit = coarse_limit(limit_of(best, slack));
        var listed = 0u;
        loop {
            while (leaves == 0u && next < params.last) {
                leaves = leaf_mask[(next - params.first) / 32u * params.count + at];
                word = next;
                next += 32u;
            }
            if (leaves == 0u || listed + 2u > LIST) { break; }
            let row = (word + firstTrailingBit(leaves)) * LEAF + lane;
            leaves &= leaves - 1u;
            let coarse = coarse_distance(row, clipped);
            let other_coarse = coarse_distance(row + LANES, clipped);
            list[listed] = row;
            listed += select(1u, 0u, coarse > limit);
            list[listed] = row + LANES;
            listed += select(1u, 0u, other_coarse > limit);
        }
        for (var i = 0u; i < listed; i++) {
            let row = list[i] * QUADS;
            let last = rows[row + 6u];
            let g = vec4f(last.xyz, 0.0);
            let exact = squared(Feature(rows[row], rows[row + 1u], rows[row + 2u], rows[row + 3u], rows[row + 4u], rows[row + 5u], g), q);
            let found = u32(last.w);
            let nearer = exact < best || (exact == best && found < candidate);
            best = select(best, exact, nearer);
            candidate = select(candidate, found, nearer);
        }
    }
    distance[mine] = best;
    candidates[mine] = candidate;
}
