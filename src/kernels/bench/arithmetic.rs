//! How fast multiplying and adding can be done. Shader: `shaders/bench/arithmetic.wgsl`.

use crate::gpu::groups;
use crate::gpu::{Buffer, Gpu, shader};
use multiversion::multiversion;
use rayon::prelude::*;

crate::shader_params! {
    pub struct Params for arithmetic {
        /// Quadruples of numbers.
        pub count: u32,
        /// Rounds, each of [`OPERATIONS`] for every quadruple.
        pub rounds: u32,
    }
}

/// Times that eight parts of each quadruple are halved in a round.
const TIMES: u32 = 4;
/// Multiplications and additions for each quadruple in a round.
pub const OPERATIONS: u64 = 2 * 4 * 8 * TIMES as u64;
/// Quadruples at a time on the CPU, to fill its registers.
const TOGETHER: usize = 4;
const NUMBERS: usize = 4 * TOGETHER;

/// Queues the shader on `gpu`.
///
/// `sums` is `[count][4]`.
pub fn launch(gpu: &Gpu, sums: &Buffer<f32>, params: &Params) {
    let groups = groups(&shader::ARITHMETIC, params.count as usize);
    gpu.launch(&shader::ARITHMETIC, groups, &[sums], params);
}

/// The shader's computation on the host. `params.count` must be a multiple of four.
pub fn twin(sums: &mut [[f32; 4]], params: &Params) {
    let sums = &mut sums[..params.count as usize];
    let (together, _) = sums.as_flattened_mut().as_chunks_mut::<NUMBERS>();
    together
        .par_iter_mut()
        .for_each(|sums| *sums = add(sums, params.rounds));
}

#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+fma",
    "x86_64+avx2+fma",
    "aarch64+neon"
))]
fn add(x: &[f32; NUMBERS], rounds: u32) -> [f32; NUMBERS] {
    let mut parts = [[0.0f32; NUMBERS]; 8];
    for (number, part) in parts.iter_mut().enumerate() {
        for (part, x) in part.iter_mut().zip(x) {
            *part = x + number as f32;
        }
    }
    // Were it known to be constant, the compiler would not use the widest registers.
    let half = std::hint::black_box([0.5f32; NUMBERS]);
    for _ in 0..rounds * TIMES {
        for part in &mut parts {
            halve(part, &half);
        }
    }
    let [a, b, c, d, e, f, g, h] = parts;
    std::array::from_fn(|i| ((a[i] + b[i]) + (c[i] + d[i])) + ((e[i] + f[i]) + (g[i] + h[i])))
}

#[inline(always)]
fn halve(part: &mut [f32; NUMBERS], half: &[f32; NUMBERS]) {
    for (part, half) in part.iter_mut().zip(half) {
        *part = part.mul_add(*half, *half);
    }
}
