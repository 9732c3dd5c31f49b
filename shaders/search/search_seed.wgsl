// A first candidate for every query, near enough that few other leaves can hold a nearer one: the
// nearest row of the group of least bound (the index: src/matching).
//
// Four queries an invocation: lavapipe fetches a box lane by lane even where all lanes want the
// same one, so each fetch must serve several queries.
//
// rows              [leaves * LEAF][QUADS] of vec4   in the index's order; the last number is the candidate
// boxes             [PCA_BOXES + groups + leaves][CORNERS] of vec4   the 12 principal axes, the groups, the leaves
// distance_codes    [frames] block of every frame; then bytes: [blocks][groups], padded to whole words, and
//                   [blocks][leaves]: the distance of the block's poses to the group's, the leaf's
// shown             [count]                          frame whose pose a query has
// queries           [count][QUADS] of vec4
// query_projection  [PROJECTION_LEN][count]          trajectory along the axes, slack
// distance, candidates  [LANES][count]               the same for all lanes

#import locomotion_layout
#import feature
#import search_index

struct Params {
    count: u32,
    groups: u32,
    // Frames of the database.
    frames: u32,
    // Distance a unit of a byte.
    step: f32,
    // Norm of the longest trajectory.
    max_norm: f32,
}

@group(0) @binding(0) var<storage, read> rows: array<vec4f>;
@group(0) @binding(1) var<storage, read> boxes: array<vec4f>;
@group(0) @binding(2) var<storage, read> distance_codes: array<u32>;
@group(0) @binding(3) var<storage, read> shown: array<u32>;
@group(0) @binding(4) var<storage, read> queries: array<vec4f>;
@group(0) @binding(5) var<storage, read_write> query_projection: array<f32>;
@group(0) @binding(6) var<storage, read_write> distance: array<f32>;
@group(0) @binding(7) var<storage, read_write> candidates: array<u32>;
@group(0) @binding(8) var<uniform> params: Params;

const QUERIES = 4u; // an invocation

struct Nearest { squared: f32, candidate: u32 }

fn load_query(at: u32) -> Feature {
    let i = at * QUADS;
    let g = vec4f(queries[i + 6u].xyz, 0.0);
    return Feature(queries[i], queries[i + 1u], queries[i + 2u], queries[i + 3u], queries[i + 4u], queries[i + 5u], g);
}

fn load_box(box: u32) -> Box {
    let i = CORNERS * (PCA_BOXES + box);
    return Box(boxes[i], boxes[i + 1u], boxes[i + 2u], boxes[i + 3u], boxes[i + 4u], boxes[i + 5u]);
}

fn along(axis: u32, p: Feature, q: Feature, r: Feature, s: Feature) -> vec4f {
    let a = boxes[3u * axis];
    let b = boxes[3u * axis + 1u];
    let c = boxes[3u * axis + 2u];
    return vec4f(on(a, b, c, p), on(a, b, c, q), on(a, b, c, r), on(a, b, c, s));
}

// A query's trajectory is its last twelve numbers.
fn on(a: vec4f, b: vec4f, c: vec4f, q: Feature) -> f32 {
    let first = vec4f(q.d.w, q.e.xyz);
    let second = vec4f(q.e.w, q.f.xyz);
    let third = vec4f(q.f.w, q.g.xyz);
    return total(fma(c, third, fma(b, second, a * first)));
}

fn project(p: Feature, q: Feature, r: Feature, s: Feature) -> Projected {
    return Projected(
        along(0u, p, q, r, s), along(1u, p, q, r, s), along(2u, p, q, r, s), along(3u, p, q, r, s),
        along(4u, p, q, r, s), along(5u, p, q, r, s), along(6u, p, q, r, s), along(7u, p, q, r, s),
        along(8u, p, q, r, s), along(9u, p, q, r, s), along(10u, p, q, r, s), along(11u, p, q, r, s),
    );
}

fn code(at: u32) -> u32 {
    return distance_codes[params.frames + at / 4u] >> (8u * (at % 4u));
}

fn four_codes(at: vec4u) -> vec4u {
    return vec4u(code(at.x), code(at.y), code(at.z), code(at.w));
}

fn block_of(query: u32) -> u32 {
    return distance_codes[shown[query]];
}

fn nearest_in(group: u32, q: Feature) -> Nearest {
    var best = Nearest(FAR, 0u);
    let end = (group + 1u) * GROUP * LEAF;
    for (var row = group * GROUP * LEAF; row < end; row++) {
        let i = row * QUADS;
        let last = rows[i + 6u];
        let g = vec4f(last.xyz, 0.0);
        let exact = squared(Feature(rows[i], rows[i + 1u], rows[i + 2u], rows[i + 3u], rows[i + 4u], rows[i + 5u], g), q);
        let candidate = u32(last.w);
        let nearer = exact < best.squared || (exact == best.squared && candidate < best.candidate);
        best = Nearest(select(best.squared, exact, nearer), select(best.candidate, candidate, nearer));
    }
    return best;
}

fn write(at: u32, group: u32, q: Feature, t: Projected, i: u32) {
    if (at >= params.count) { return; }
    let best = nearest_in(group, q);
    let count = params.count;
    for (var lane = 0u; lane < LANES; lane++) {
        distance[lane * count + at] = best.squared;
        candidates[lane * count + at] = best.candidate;
    }
    query_projection[at] = t.a[i];
    query_projection[at + count] = t.b[i];
    query_projection[at + 2u * count] = t.c[i];
    query_projection[at + 3u * count] = t.d[i];
    query_projection[at + 4u * count] = t.e[i];
    query_projection[at + 5u * count] = t.f[i];
    query_projection[at + 6u * count] = t.g[i];
    query_projection[at + 7u * count] = t.h[i];
    query_projection[at + 8u * count] = t.i[i];
    query_projection[at + 9u * count] = t.j[i];
    query_projection[at + 10u * count] = t.k[i];
    query_projection[at + 11u * count] = t.l[i];
    query_projection[at + 12u * count] = SLACK * (params.max_norm + length_of(q));
}

@compute @workgroup_size(8)
fn search_seed(@builtin(workgroup_id) group_id: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let at = group_id.x * LANES * QUERIES + local.x + vec4u(0u, LANES, 2u * LANES, 3u * LANES);
    // Queries past the end repeat the last one and are not written.
    let known = min(at, vec4u(params.count - 1u));
    let p = load_query(known.x);
    let q = load_query(known.y);
    let r = load_query(known.z);
    let s = load_query(known.w);
    let t = project(p, q, r, s);
    let block = vec4u(block_of(known.x), block_of(known.y), block_of(known.z), block_of(known.w));
    var least = vec4f(FAR);
    var nearest = vec4u(0u);
    for (var group = 0u; group < params.groups; group++) {
        let poses = squares(four_codes(block * params.groups + group), params.step);
        let bound = bounds(load_box(group), t, poses);
        nearest = select(nearest, vec4u(group), bound < least);
        least = min(least, bound);
    }
    write(at.x, nearest.x, p, t, 0u);
    write(at.y, nearest.y, q, t, 1u);
    write(at.z, nearest.z, r, t, 2u);
    write(at.w, nearest.w, s, t, 3u);
}
