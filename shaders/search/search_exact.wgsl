// The nearest candidate of every query, exactly: of the blocks that search_wide or search_tile
// scored, those that rounding leaves in question are compared row by row, and of equal distances
// the lowest index wins. One invocation a query.
//
// A score is a sum of 28 products, wrong by at most g (|q| R + R^2 / 2) with g = 28 u / (1 - 28 u),
// u = 2^-24 and R the longest row (Higham, Accuracy and Stability, section 3.1); its stored half
// square adds g R^2 / 2, the distance compared in the end g (|q| + R)^2 / 2. A block whose score is
// more than twice their sum below the best holds no nearest row; 128 u (|q| + R)^2 is more.
//
// rows     [candidates][QUADS] of vec4   normalised features; the last number is not compared
// queries  [count][QUADS] of vec4
// score    [blocks][count]
// matched  [count]

#import layout

struct Params {
    count: u32,
    candidates: u32,
    block: u32,
    // Length of the longest row.
    longest: f32,
}

@group(0) @binding(0) var<storage, read> rows: array<vec4f>;
@group(0) @binding(1) var<storage, read> queries: array<vec4f>;
@group(0) @binding(2) var<storage, read> score: array<f32>;
@group(0) @binding(3) var<storage, read_write> matched: array<u32>;
@group(0) @binding(4) var<uniform> params: Params;

const MARGIN = 7.6293945e-6; // 128 * 2^-24

@compute @workgroup_size(64)
fn search_exact(@builtin(global_invocation_id) id: vec3u) {
    let at = id.x;
    if (at >= params.count) { return; }
    let i = at * QUADS;
    let a = queries[i];
    let b = queries[i + 1u];
    let c = queries[i + 2u];
    let d = queries[i + 3u];
    let e = queries[i + 4u];
    let f = queries[i + 5u];
    let g = vec4f(queries[i + 6u].xyz, 0.0);
    let squares = a * a + b * b + c * c + d * d + e * e + f * f + g * g;
    let reach = sqrt((squares.x + squares.y) + (squares.z + squares.w)) + params.longest;

    let blocks = (params.candidates + params.block - 1u) / params.block;
    var top = score[at];
    for (var block = 1u; block < blocks; block++) {
        top = max(top, score[block * params.count + at]);
    }
    let least = top - MARGIN * reach * reach;

    var best = 3.4e38;
    var found = 0u;
    for (var block = 0u; block < blocks; block++) {
        if (score[block * params.count + at] < least) { continue; }
        let end = min((block + 1u) * params.block, params.candidates);
        for (var row = block * params.block; row < end; row++) {
            let j = row * QUADS;
            let ga = rows[j] - a;
            let gb = rows[j + 1u] - b;
            let gc = rows[j + 2u] - c;
            let gd = rows[j + 3u] - d;
            let ge = rows[j + 4u] - e;
            let gf = rows[j + 5u] - f;
            let gg = vec4f(rows[j + 6u].xyz, 0.0) - g;
            let sum = fma(gg, gg, fma(gf, gf, fma(ge, ge, fma(gd, gd, fma(gc, gc, fma(gb, gb, ga * ga))))));
            let distance = (sum.x + sum.y) + (sum.z + sum.w);
            if (distance < best) {
                best = distance;
                found = row;
            }
        }
    }
    matched[at] = found;
}
