// Nearest candidate of every query within a chunk of the database, by comparing with every row.
// The form for real GPUs: a workgroup compares 64 queries with 64 rows at a time out of
// workgroup memory; each of its 16 x 16 invocations keeps 4 x 4 distances in registers.
// Pieces are joined by search_merge.
//
// rows       [candidates][QUADS] of vec4   normalised features, padded with zeros
// queries    [count][QUADS] of vec4
// distance   [chunks][count]   squared, of the best row of the chunk
// index      [chunks][count]   that row, the lowest of equals

#import layout

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

const TILE = 64u;
const SIDE = 16u; // invocations along each side
const FAR = 3.4e38;

var<workgroup> tile_rows: array<vec4f, 448>;    // [TILE][QUADS]
// Held as integers because it carries indices in the end, which floats could flush to zero.
var<workgroup> tile_queries: array<vec4u, 448>; // [TILE][QUADS]

struct Nearest { best: vec4f, found: vec4u }

fn keep(nearest: Nearest, distances: vec4f, at: u32, valid: bool) -> Nearest {
    let closer = (distances < nearest.best) & vec4<bool>(valid);
    return Nearest(select(nearest.best, distances, closer), select(nearest.found, vec4u(at), closer));
}

@compute @workgroup_size(256)
fn search_tile(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    let across = local % SIDE; // which rows
    let down = local / SIDE;   // which queries
    let first = group.x * TILE;
    let begin = group.y * params.chunk;
    let end = min(begin + params.chunk, params.candidates);
    for (var i = local; i < TILE * QUADS; i += 256u) {
        // Queries past the end repeat the last one and are not written.
        tile_queries[i] = bitcast<vec4u>(queries[min(first + i / QUADS, params.count - 1u) * QUADS + i % QUADS]);
    }
    var nearest = Nearest(vec4f(FAR), vec4u(begin));
    for (var base = begin; base < end; base += TILE) {
        for (var i = local; i < TILE * QUADS; i += 256u) {
            tile_rows[i] = rows[min(base + i / QUADS, params.candidates - 1u) * QUADS + i % QUADS];
        }
        workgroupBarrier();
        var d0 = vec4f(0.0);
        var d1 = vec4f(0.0);
        var d2 = vec4f(0.0);
        var d3 = vec4f(0.0);
        for (var k = 0u; k < QUADS; k++) {
            let q0 = bitcast<vec4f>(tile_queries[down * QUADS + k]);
            let q1 = bitcast<vec4f>(tile_queries[(down + SIDE) * QUADS + k]);
            let q2 = bitcast<vec4f>(tile_queries[(down + 2u * SIDE) * QUADS + k]);
            let q3 = bitcast<vec4f>(tile_queries[(down + 3u * SIDE) * QUADS + k]);
            let r0 = tile_rows[across * QUADS + k];
            let r1 = tile_rows[(across + SIDE) * QUADS + k];
            let r2 = tile_rows[(across + 2u * SIDE) * QUADS + k];
            let r3 = tile_rows[(across + 3u * SIDE) * QUADS + k];
            d0 += vec4f(dot(q0 - r0, q0 - r0), dot(q1 - r0, q1 - r0), dot(q2 - r0, q2 - r0), dot(q3 - r0, q3 - r0));
            d1 += vec4f(dot(q0 - r1, q0 - r1), dot(q1 - r1, q1 - r1), dot(q2 - r1, q2 - r1), dot(q3 - r1, q3 - r1));
            d2 += vec4f(dot(q0 - r2, q0 - r2), dot(q1 - r2, q1 - r2), dot(q2 - r2, q2 - r2), dot(q3 - r2, q3 - r2));
            d3 += vec4f(dot(q0 - r3, q0 - r3), dot(q1 - r3, q1 - r3), dot(q2 - r3, q2 - r3), dot(q3 - r3, q3 - r3));
        }
        let at = base + across;
        nearest = keep(nearest, d0, at, at < end);
        nearest = keep(nearest, d1, at + SIDE, at + SIDE < end);
        nearest = keep(nearest, d2, at + 2u * SIDE, at + 2u * SIDE < end);
        nearest = keep(nearest, d3, at + 3u * SIDE, at + 3u * SIDE < end);
        workgroupBarrier();
    }

    // The tiles' memory now carries each invocation's best: [down][across].
    tile_rows[local] = nearest.best;
    tile_queries[local] = nearest.found;
    workgroupBarrier();
    if (local < TILE) {
        // Query `local` of the tile belongs to row local % SIDE, component local / SIDE.
        let owner = (local % SIDE) * SIDE;
        let part = local / SIDE;
        var best = FAR;
        var found = 0xffffffffu;
        for (var other = 0u; other < SIDE; other++) {
            let d = tile_rows[owner + other][part];
            let i = tile_queries[owner + other][part];
            if (d < best || (d == best && i < found)) {
                best = d;
                found = i;
            }
        }
        if (first + local < params.count) {
            distance[group.y * params.count + first + local] = best;
            index[group.y * params.count + first + local] = found;
        }
    }
}
