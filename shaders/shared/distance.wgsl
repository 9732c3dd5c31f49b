// A padded feature row in registers.
struct Feature { a: vec4f, b: vec4f, c: vec4f, d: vec4f, e: vec4f, f: vec4f, g: vec4f }

// Squared Euclidean distance.
fn squared(p: Feature, q: Feature) -> f32 {
    let a = p.a - q.a;
    let b = p.b - q.b;
    let c = p.c - q.c;
    let d = p.d - q.d;
    let e = p.e - q.e;
    let f = p.f - q.f;
    let g = p.g - q.g;
    let sum = fma(g, g, fma(f, f, fma(e, e, fma(d, d, fma(c, c, fma(b, b, a * a))))));
    return (sum.x + sum.y) + (sum.z + sum.w);
}
