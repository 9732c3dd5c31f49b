// Joins the chunks' winners of search_wide or search_tile: the smallest distance, the lowest
// index of equals. One invocation a query.
//
// distance  [chunks][count]
// index     [chunks][count]
// matched   [count]

struct Params {
    count: u32,
    chunks: u32,
}

@group(0) @binding(0) var<storage, read> distance: array<f32>;
@group(0) @binding(1) var<storage, read> index: array<u32>;
@group(0) @binding(2) var<storage, read_write> matched: array<u32>;
@group(0) @binding(3) var<uniform> params: Params;

@compute @workgroup_size(64)
fn search_merge(@builtin(global_invocation_id) id: vec3u) {
    let at = id.x;
    if (at >= params.count) { return; }
    var best = distance[at];
    var found = index[at];
    // Chunks are in ascending order, so the first of equals has the lowest index.
    for (var chunk = 1u; chunk < params.chunks; chunk++) {
        let d = distance[chunk * params.count + at];
        if (d < best) {
            best = d;
            found = index[chunk * params.count + at];
        }
    }
    matched[at] = found;
}
