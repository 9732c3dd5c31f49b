// The nearest of what the lanes of search_leaves found for a query, of equals the lowest candidate.
//
// distance, candidates  [LANES][count]
// matched               [count]

#import search_index

struct Params {
    count: u32,
}

@group(0) @binding(0) var<storage, read> distance: array<f32>;
@group(0) @binding(1) var<storage, read> candidates: array<u32>;
@group(0) @binding(2) var<storage, read_write> matched: array<u32>;
@group(0) @binding(3) var<uniform> params: Params;

@compute @workgroup_size(64)
fn search_argmin(@builtin(global_invocation_id) id: vec3u) {
    let at = id.x;
    if (at >= params.count) { return; }
    var best = distance[at];
    var candidate = candidates[at];
    for (var lane = 1u; lane < LANES; lane++) {
        let squared = distance[lane * params.count + at];
        let other = candidates[lane * params.count + at];
        if (squared < best || (squared == best && other < candidate)) {
            best = squared;
            candidate = other;
        }
    }
    matched[at] = candidate;
}
