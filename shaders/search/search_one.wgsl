// The nearest row of one query, for one character in a window or a page: invocations share the rows, where the other
// searches share the queries. Every workgroup leaves the nearest of its rows; the host takes the nearest of these, of
// equals the lowest row.
//
// rows     [candidates][QUADS] of vec4   normalised features; the last number is not compared
// query    [QUADS] of vec4
// nearest  [workgroups] of vec2          the bits of the squared distance, the row

#import locomotion_layout

struct Params {
    candidates: u32,
    // Workgroups launched.
    groups: u32,
}

@group(0) @binding(0) var<storage, read> rows: array<vec4f>;
@group(0) @binding(1) var<storage, read> query: array<vec4f>;
@group(0) @binding(2) var<storage, read_write> nearest: array<vec2u>;
@group(0) @binding(3) var<uniform> params: Params;

const LANES = 64u;
// Bits of infinity: of positive floats the larger one has the larger bits.
const FARTHEST = 0x7f800000u;

var<workgroup> found: array<vec2u, 64>;

fn squared(row: u32) -> f32 {
    var sum = vec4f(0.0);
    for (var quad = 0u; quad < QUADS - 1u; quad++) {
        let d = rows[row * QUADS + quad] - query[quad];
        sum = fma(d, d, sum);
    }
    let last = rows[row * QUADS + QUADS - 1u].xyz - query[QUADS - 1u].xyz;
    let d = vec4f(last, 0.0);
    sum = fma(d, d, sum);
    return (sum.x + sum.y) + (sum.z + sum.w);
}

@compute @workgroup_size(64)
fn search_one(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    var best = vec2u(FARTHEST, 0u);
    for (var row = group.x * LANES + lane; row < params.candidates; row += params.groups * LANES) {
        let bits = bitcast<u32>(squared(row));
        // Rows ascend: of equals the first stays.
        if (bits < best.x) { best = vec2u(bits, row); }
    }
    found[lane] = best;
    workgroupBarrier();
    if (lane == 0u) {
        for (var other = 1u; other < LANES; other++) {
            let candidate = found[other];
            if (candidate.x < best.x || (candidate.x == best.x && candidate.y < best.y)) {
                best = candidate;
            }
        }
        nearest[group.x] = best;
    }
}
