// A padded feature row in registers, and its squared distance to another in the four interleaved sums
// of every form of the search; the last number, which is no feature, must be the same in both.

struct Feature { a: vec4f, b: vec4f, c: vec4f, d: vec4f, e: vec4f, f: vec4f, g: vec4f }

fn total(v: vec4f) -> f32 {
    return (v.x + v.y) + (v.z + v.w);
}

fn squared(row: Feature, q: Feature) -> f32 {
    let a = row.a - q.a;
    let b = row.b - q.b;
    let c = row.c - q.c;
    let d = row.d - q.d;
    let e = row.e - q.e;
    let f = row.f - q.f;
    let g = row.g - q.g;
    return total(fma(g, g, fma(f, f, fma(e, e, fma(d, d, fma(c, c, fma(b, b, a * a)))))));
}

fn length_of(q: Feature) -> f32 {
    return sqrt(total(q.a * q.a + q.b * q.b + q.c * q.c + q.d * q.d + q.e * q.e + q.f * q.f + q.g * q.g));
}
