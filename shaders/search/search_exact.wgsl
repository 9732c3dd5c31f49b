// The nearest candidate of every query, exactly: of the blocks that search_score_lanes or search_score_tiled
// scored, those that rounding leaves in question are compared row by row, and of equal distances
// the lowest index wins. One invocation a query.
//
// A score is a sum of 28 products, wrong by at most g (|q| R + R^2 / 2) with g = 28 u / (1 - 28 u),
// u = 2^-24 and R the norm of the longest row (Higham, Accuracy and Stability, section 3.1); its stored half
// square adds g R^2 / 2, the distance compared in the end g (|q| + R)^2 / 2. A block whose score is
// more than twice their sum below the best holds no nearest row; 128 u (|q| + R)^2 is more.
//
// Lavapipe silently stops an invocation after 65,535 loop iterations. A far-away query leaves every
// block in question, so four rows an iteration are compared, and a launch looks at a bounded run of
// blocks; the next one goes on from the row in `matched`.
//
// rows     [candidates][QUADS] of vec4   normalised features; the last number is not compared
// queries  [count][QUADS] of vec4
// score    [blocks][count]
// matched  [count]                       read if `first` is not 0

#import locomotion_layout

struct Params {
    count: u32,
    candidates: u32,
    block: u32,
    // The blocks compared in this launch: first .. last - 1.
    first: u32,
    last: u32,
    // Norm of the longest row.
    max_norm: f32,
}

@group(0) @binding(0) var<storage, read> rows: array<vec4f>;
@group(0) @binding(1) var<storage, read> queries: array<vec4f>;
@group(0) @binding(2) var<storage, read> score: array<f32>;
@group(0) @binding(3) var<storage, read_write> matched: array<u32>;
@group(0) @binding(4) var<uniform> params: Params;

const MARGIN = 7.6293945e-6; // 128 * 2^-24

struct Feature { a: vec4f, b: vec4f, c: vec4f, d: vec4f, e: vec4f, f: vec4f, g: vec4f }

fn squared(row: u32, q: Feature) -> f32 {
    let i = row * QUADS;
    let a = rows[i] - q.a;
    let b = rows[i + 1u] - q.b;
    let c = rows[i + 2u] - q.c;
    let d = rows[i + 3u] - q.d;
    let e = rows[i + 4u] - q.e;
    let f = rows[i + 5u] - q.f;
    let g = vec4f(rows[i + 6u].xyz, 0.0) - q.g;
    let sum = fma(g, g, fma(f, f, fma(e, e, fma(d, d, fma(c, c, fma(b, b, a * a))))));
    return (sum.x + sum.y) + (sum.z + sum.w);
}

@compute @workgroup_size(64)
fn search_exact(@builtin(global_invocation_id) id: vec3u) {
    let at = id.x;
    if (at >= params.count) { return; }
    let i = at * QUADS;
    let q = Feature(
        queries[i], queries[i + 1u], queries[i + 2u], queries[i + 3u], queries[i + 4u], queries[i + 5u],
        vec4f(queries[i + 6u].xyz, 0.0),
    );
    let squares = q.a * q.a + q.b * q.b + q.c * q.c + q.d * q.d + q.e * q.e + q.f * q.f + q.g * q.g;
    let norms = sqrt((squares.x + squares.y) + (squares.z + squares.w)) + params.max_norm;

    let blocks = (params.candidates + params.block - 1u) / params.block;
    var top = score[at];
    for (var block = 1u; block < blocks; block++) {
        top = max(top, score[block * params.count + at]);
    }
    let least = top - MARGIN * norms * norms;

    var best = 3.4e38;
    var found = 0u;
    if (params.first > 0u) {
        found = matched[at];
        best = squared(found, q);
    }
    for (var block = params.first; block < params.last; block++) {
        if (score[block * params.count + at] < least) { continue; }
        let end = min((block + 1u) * params.block, params.candidates) - 1u;
        for (var row = block * params.block; row <= end; row += 4u) {
            // Past the end the last row again, which is not nearer than itself.
            let distances = vec4f(
                squared(row, q),
                squared(min(row + 1u, end), q),
                squared(min(row + 2u, end), q),
                squared(min(row + 3u, end), q),
            );
            if (distances[0] < best) { best = distances[0]; found = row + 0u; }
            if (distances[1] < best) { best = distances[1]; found = row + 1u; }
            if (distances[2] < best) { best = distances[2]; found = row + 2u; }
            if (distances[3] < best) { best = distances[3]; found = row + 3u; }
        }
    }
    matched[at] = found;
}
