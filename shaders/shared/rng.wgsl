// Counter-based random numbers keyed by (seed, environment, clock, stream). Integer arithmetic
// only, so that the twin in src/kernels/rng.rs agrees bit for bit.
// pcg4d: Jarzynski and Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020.

fn random4(seed: u32, environment: u32, clock: u32, stream: u32) -> vec4u {
    var v = vec4u(seed, environment, clock, stream) * 1664525u + 1013904223u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    v ^= v >> vec4u(16u);
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    return v;
}

// [0, 1) in steps of 2^-24: exact in f32.
fn uniform01(bits: u32) -> f32 {
    return f32(bits >> 8u) * 5.9604645e-8;
}

// 0 .. below - 1 by the high word of a 32 x 32 product, put together from 16-bit halves.
fn index_below(bits: u32, below: u32) -> u32 {
    let low = (bits & 0xffffu) * (below & 0xffffu);
    let middle_a = (bits >> 16u) * (below & 0xffffu) + (low >> 16u);
    let middle_b = (bits & 0xffffu) * (below >> 16u) + (middle_a & 0xffffu);
    return (bits >> 16u) * (below >> 16u) + (middle_a >> 16u) + (middle_b >> 16u);
}

// Standard normal from 128 random bits: the binomial count of 96 of them, smoothed by a
// uniform step from the other 32. Variance 24 + 1/12; integers up to one exact conversion and
// one multiplication. Excess kurtosis -0.02, reaches 9.8 deviations.
fn gaussian(bits: vec4u) -> f32 {
    let count = i32(countOneBits(bits.x) + countOneBits(bits.y) + countOneBits(bits.z)) - 48;
    // 2^-16 steps fit f32's 24 bits exactly: |count| <= 48 needs 6 bits and a sign.
    let fine = (count << 16u) + i32(bits.w >> 16u) - 32768;
    return f32(fine) * 3.109294e-6; // 2^-16 / sqrt(24 + 1/12)
}
