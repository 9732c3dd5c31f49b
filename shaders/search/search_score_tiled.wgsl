// Scores every block of the database for every query, as search_score_lanes does.
// The form for real GPUs: a workgroup scores 64 queries against 64 rows at a time out of
// workgroup memory; each of its 16 x 16 invocations keeps 4 x 4 scores in registers.
//
// rows     [candidates][QUADS] of vec4   normalised features; the last number is -|r|^2 / 2
// queries  [count][QUADS] of vec4        the last number is 1
// score    [blocks][count]

#import locomotion_layout

struct Params {
    count: u32,
    candidates: u32,
    block: u32,
    // Blocks a workgroup scores.
    run: u32,
}

@group(0) @binding(0) var<storage, read> rows: array<vec4f>;
@group(0) @binding(1) var<storage, read> queries: array<vec4f>;
@group(0) @binding(2) var<storage, read_write> score: array<f32>;
@group(0) @binding(3) var<uniform> params: Params;

const TILE = 64u;
const SIDE = 16u; // invocations along each side
const LEAST = -3.4e38;

var<workgroup> tile_rows: array<vec4f, 448>;    // [TILE][QUADS]
var<workgroup> tile_queries: array<vec4f, 448>; // [TILE][QUADS]

@compute @workgroup_size(256)
fn search_score_tiled(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let across = local % SIDE; // which rows
    let down = local / SIDE;   // which queries
    let first = group.x * TILE;
    let blocks = (params.candidates + params.block - 1u) / params.block;
    let last = min((group.y + 1u) * params.run, blocks);
    for (var i = local; i < TILE * QUADS; i += 256u) {
        // Queries past the end repeat the last one and are not written.
        tile_queries[i] = queries[min(first + i / QUADS, params.count - 1u) * QUADS + i % QUADS];
    }
    for (var block = group.y * params.run; block < last; block++) {
        let end = min((block + 1u) * params.block, params.candidates);
        var best = vec4f(LEAST);
        for (var base = block * params.block; base < end; base += TILE) {
            for (var i = local; i < TILE * QUADS; i += 256u) {
                // Rows past the end repeat the last one, which changes nothing.
                tile_rows[i] = rows[min(base + i / QUADS, end - 1u) * QUADS + i % QUADS];
            }
            workgroupBarrier();
            var s0 = vec4f(0.0);
            var s1 = vec4f(0.0);
            var s2 = vec4f(0.0);
            var s3 = vec4f(0.0);
            for (var k = 0u; k < QUADS; k++) {
                let q0 = tile_queries[down * QUADS + k];
                let q1 = tile_queries[(down + SIDE) * QUADS + k];
                let q2 = tile_queries[(down + 2u * SIDE) * QUADS + k];
                let q3 = tile_queries[(down + 3u * SIDE) * QUADS + k];
                let r0 = tile_rows[across * QUADS + k];
                let r1 = tile_rows[(across + SIDE) * QUADS + k];
                let r2 = tile_rows[(across + 2u * SIDE) * QUADS + k];
                let r3 = tile_rows[(across + 3u * SIDE) * QUADS + k];
                s0 += vec4f(dot(q0, r0), dot(q1, r0), dot(q2, r0), dot(q3, r0));
                s1 += vec4f(dot(q0, r1), dot(q1, r1), dot(q2, r1), dot(q3, r1));
                s2 += vec4f(dot(q0, r2), dot(q1, r2), dot(q2, r2), dot(q3, r2));
                s3 += vec4f(dot(q0, r3), dot(q1, r3), dot(q2, r3), dot(q3, r3));
            }
            best = max(best, max(max(s0, s1), max(s2, s3)));
            workgroupBarrier();
        }
        // The rows' memory now carries each invocation's best, [down][across].
        tile_rows[local] = best;
        workgroupBarrier();
        if (local < TILE && first + local < params.count) {
            // Query `local` of the tile is component local / SIDE of row local % SIDE.
            var top = LEAST;
            for (var other = 0u; other < SIDE; other++) {
                top = max(top, tile_rows[(local % SIDE) * SIDE + other][local / SIDE]);
            }
            score[block * params.count + first + local] = top;
        }
        workgroupBarrier();
    }
}
