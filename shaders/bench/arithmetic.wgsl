// Multiplies and adds in registers, to see how fast that can be done: 64 operations a round.
//
// sums  [count] of vec4

struct Params {
    count: u32,
    rounds: u32,
}

@group(0) @binding(0) var<storage, read_write> sums: array<vec4f>;
@group(0) @binding(1) var<uniform> params: Params;

@compute @workgroup_size(64)
fn arithmetic(@builtin(global_invocation_id) id: vec3u) {
    let at = id.x;
    if (at >= params.count) { return; }
    let x = sums[at];
    var a = x;
    var b = x + vec4f(1.0);
    var c = x + vec4f(2.0);
    var d = x + vec4f(3.0);
    var e = x + vec4f(4.0);
    var f = x + vec4f(5.0);
    var g = x + vec4f(6.0);
    var h = x + vec4f(7.0);
    // Towards 1, so that nothing overflows however many rounds there are.
    let less = vec4f(0.5);
    for (var round = 0u; round < params.rounds; round++) {
        a = fma(a, less, less);
        b = fma(b, less, less);
        c = fma(c, less, less);
        d = fma(d, less, less);
        e = fma(e, less, less);
        f = fma(f, less, less);
        g = fma(g, less, less);
        h = fma(h, less, less);
    }
    sums[at] = ((a + b) + (c + d)) + ((e + f) + (g + h));
}
