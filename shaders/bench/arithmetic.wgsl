// Multiplies and adds in registers, to see how fast that can be done: 256 operations a round, so
// that the loop itself hardly counts.
//
// sums  [count] of vec4

struct Params {
    count: u32,
    rounds: u32,
}

@group(0) @binding(0) var<storage, read_write> sums: array<vec4f>;
@group(0) @binding(1) var<uniform> params: Params;

// Towards 1, so that nothing overflows however many rounds there are.
fn halve(x: vec4f) -> vec4f {
    let half = vec4f(0.5);
    return fma(fma(fma(fma(x, half, half), half, half), half, half), half, half);
}

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
    for (var round = 0u; round < params.rounds; round++) {
        a = halve(a);
        b = halve(b);
        c = halve(c);
        d = halve(d);
        e = halve(e);
        f = halve(f);
        g = halve(g);
        h = halve(h);
    }
    sums[at] = ((a + b) + (c + d)) + ((e + f) + (g + h));
}
