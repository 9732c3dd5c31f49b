//! Products of matrices, one of which is made of patches read where they lie in the input.
//!
//! [`microkernel`] cuts a matrix of results into blocks of rows by SIMD lanes; a [`GemmKernel`] adds up one
//! block in vector registers and then stores it. Summing and storing are apart, and blocks have
//! no more than eight rows, because only then does the compiler keep the sums in registers.

use crate::kernels::fma::mul_add;
use multiversion::{multiversion, target::target_cfg_f};

/// A block of a matrix of results.
type Sums<const ROWS: usize, const LANES: usize> = [[f32; LANES]; ROWS];

pub trait GemmKernel {
    /// Sums of the block of which `row` and `lane` are the first.
    fn sums<const ROWS: usize, const LANES: usize>(
        &self,
        row: usize,
        lane: usize,
    ) -> Sums<ROWS, LANES>;

    /// Puts a row of a block where it belongs.
    fn store<const LANES: usize>(&mut self, row: usize, lane: usize, sums: &[f32; LANES]);
}

/// Computes a whole matrix of results, `[rows][lanes]`, in blocks that fit the registers.
#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+fma",
    "x86_64+avx2+fma",
    "aarch64+neon"
))]
pub fn microkernel<K: GemmKernel>(kernel: &mut K, rows: usize, lanes: usize) {
    let mut lane = 0;
    if target_cfg_f!(target_feature = "avx512f") {
        while lanes - lane >= 32 {
            column::<8, 32>(kernel, rows, lane);
            lane += 32;
        }
        while lanes - lane >= 16 {
            column::<8, 16>(kernel, rows, lane);
            lane += 16;
        }
    }
    while lanes - lane >= 16 {
        column::<4, 16>(kernel, rows, lane);
        lane += 16;
    }
    while lanes - lane >= 8 {
        column::<8, 8>(kernel, rows, lane);
        lane += 8;
    }
    while lanes - lane >= 4 {
        column::<8, 4>(kernel, rows, lane);
        lane += 4;
    }
    for lane in lane..lanes {
        column::<8, 1>(kernel, rows, lane);
    }
}

#[inline(always)]
fn column<const ROWS: usize, const LANES: usize>(
    kernel: &mut impl GemmKernel,
    rows: usize,
    lane: usize,
) {
    let whole = rows - rows % ROWS;
    for row in (0..whole).step_by(ROWS) {
        block::<ROWS, LANES>(kernel, row, lane);
    }
    for row in whole..rows {
        block::<1, LANES>(kernel, row, lane);
    }
}

#[inline(always)]
fn block<const ROWS: usize, const LANES: usize>(
    kernel: &mut impl GemmKernel,
    row: usize,
    lane: usize,
) {
    let sums = kernel.sums::<ROWS, LANES>(row, lane);
    for (r, sums) in sums.iter().enumerate() {
        kernel.store(row + r, lane, sums);
    }
}

/// Activations: output pixels by filters.
pub struct Forward<'a> {
    pub patch_offsets: &'a [usize],
    pub patch_row_len: usize,
    pub row_stride: usize,
    pub input: &'a [f32],
    /// `[size][patch_row_len][filters]`
    pub weights: &'a [f32],
    pub biases: &'a [f32],
    /// Smaller sums are raised to this.
    pub least: f32,
    pub output: &'a mut [f32],
}

impl GemmKernel for Forward<'_> {
    #[inline(always)]
    fn sums<const ROWS: usize, const LANES: usize>(
        &self,
        row: usize,
        lane: usize,
    ) -> Sums<ROWS, LANES> {
        let filters = self.biases.len();
        let patch_offsets = array::<ROWS, _>(self.patch_offsets, row);
        let mut sums = [*array(self.biases, lane); ROWS];
        for (y, weights) in self
            .weights
            .chunks_exact(self.patch_row_len * filters)
            .enumerate()
        {
            let patches = patch_offsets
                .map(|offset| &self.input[offset + y * self.row_stride..][..self.patch_row_len]);
            accumulate(&mut sums, patches, weights, filters, lane);
        }
        sums
    }

    #[inline(always)]
    fn store<const LANES: usize>(&mut self, row: usize, lane: usize, sums: &[f32; LANES]) {
        let output = &mut self.output[row * self.biases.len() + lane..][..LANES];
        let least = self.least;
        output.copy_from_slice(&sums.map(|sum| if sum > least { sum } else { least }));
    }
}

/// Gradient of a row of the filters' weights: floats of a row of a patch by filters.
pub struct WeightGradient<'a> {
    pub patch_offsets: &'a [usize],
    pub filters: usize,
    pub input: &'a [f32],
    /// `[pixels][filters]`
    pub gradient: &'a [f32],
    /// Added to.
    pub output: &'a mut [f32],
}

impl GemmKernel for WeightGradient<'_> {
    #[inline(always)]
    fn sums<const ROWS: usize, const LANES: usize>(
        &self,
        row: usize,
        lane: usize,
    ) -> Sums<ROWS, LANES> {
        let mut sums = [[0.0; LANES]; ROWS];
        let pixels = self.gradient.chunks_exact(self.filters);
        for (offset, gradient) in self.patch_offsets.iter().zip(pixels) {
            let values = array::<ROWS, _>(self.input, offset + row);
            let gradient = array(gradient, lane);
            for r in 0..ROWS {
                fma_row(&mut sums[r], values[r], gradient);
            }
        }
        sums
    }

    #[inline(always)]
    fn store<const LANES: usize>(&mut self, row: usize, lane: usize, sums: &[f32; LANES]) {
        add(self.output, row * self.filters + lane, sums);
    }
}

/// Gradient with respect to the input: output pixels by floats of a row of their patches.
pub struct InputGradient<'a> {
    pub patch_offsets: &'a [usize],
    pub patch_row_len: usize,
    pub filters: usize,
    /// `[filters][patch_row_len]`
    pub weights: &'a [f32],
    /// `[pixels][filters]`
    pub gradient: &'a [f32],
    /// Added to, patch by patch: they overlap.
    pub output: &'a mut [f32],
}

impl GemmKernel for InputGradient<'_> {
    #[inline(always)]
    fn sums<const ROWS: usize, const LANES: usize>(
        &self,
        row: usize,
        lane: usize,
    ) -> Sums<ROWS, LANES> {
        let mut sums = [[0.0; LANES]; ROWS];
        let gradient = &self.gradient[row * self.filters..];
        let pixels = std::array::from_fn(|r| &gradient[r * self.filters..][..self.filters]);
        accumulate(&mut sums, pixels, self.weights, self.patch_row_len, lane);
        sums
    }

    #[inline(always)]
    fn store<const LANES: usize>(&mut self, row: usize, lane: usize, sums: &[f32; LANES]) {
        add(self.output, self.patch_offsets[row] + lane, sums);
    }
}

/// Adds the product of `values`, `[ROWS][terms]`, and the columns at `lane` of `weights`,
/// `[terms][width]`.
#[inline(always)]
fn accumulate<const ROWS: usize, const LANES: usize>(
    sums: &mut Sums<ROWS, LANES>,
    values: [&[f32]; ROWS],
    weights: &[f32],
    width: usize,
    lane: usize,
) {
    let terms = weights.len() / width;
    // Said once, so that it is not checked at every term.
    assert!(values.iter().all(|values| values.len() == terms));
    for (term, weights) in weights.chunks_exact(width).enumerate() {
        let weights = array(weights, lane);
        for r in 0..ROWS {
            fma_row(&mut sums[r], values[r][term], weights);
        }
    }
}

#[inline(always)]
fn fma_row<const LANES: usize>(sums: &mut [f32; LANES], value: f32, weights: &[f32; LANES]) {
    for (sum, weight) in sums.iter_mut().zip(weights) {
        *sum = mul_add(value, *weight, *sum);
    }
}

#[inline(always)]
fn add<const LANES: usize>(output: &mut [f32], at: usize, sums: &[f32; LANES]) {
    let before = *array::<LANES, _>(output, at);
    let after: [f32; LANES] = std::array::from_fn(|lane| before[lane] + sums[lane]);
    output[at..][..LANES].copy_from_slice(&after);
}

#[inline(always)]
fn array<const LENGTH: usize, T>(values: &[T], at: usize) -> &[T; LENGTH] {
    match values[at..].first_chunk() {
        Some(array) => array,
        None => unreachable!("blocks lie inside their matrices"),
    }
}
