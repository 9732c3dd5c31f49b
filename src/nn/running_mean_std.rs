//! Running mean and standard deviation of the columns of a stream of rows, as observations are
//! normalised by.

use crate::container::{Section, SectionError};
use crate::gpu::{Array, Device};
#[cfg(feature = "gpu")]
use crate::nn::gpu::moments;
use crate::ranks::Ranks;
use anyhow::Result;
use rayon::prelude::*;

/// Normalised numbers are at most this large.
pub const CLIP: f32 = 10.0;
/// Smaller standard deviations count as this.
const MIN_STD: f32 = 1e-2;
/// Rows whose sums a core takes in one go: what is summed over must not depend on how many there are.
const CHUNK_ROWS: usize = 1024;

/// The mean and variance of all rows so far, on a device.
#[derive(Clone)]
pub struct RunningMeanStd {
    device: Device,
    /// `[2][dim]`: means, then variances.
    moments: Array,
    dim: usize,
    /// Rows so far.
    count: f64,
}

impl RunningMeanStd {
    /// Means of 0 and variances of 1, of rows of `dim` numbers.
    pub fn new(device: &Device, dim: usize) -> Self {
        let moments = [vec![0.0; dim], vec![1.0; dim]].concat();
        RunningMeanStd {
            device: device.clone(),
            moments: Array::from_slice(device, &moments),
            dim,
            count: 0.0,
        }
    }

    /// Numbers of a row.
    pub fn dim(&self) -> usize {
        self.dim
    }

    /// Takes rows `[rows][dim]` in.
    pub fn update(&mut self, values: &Array, rows: usize) {
        let weight = self.weigh(rows);
        self.take_in(values, rows, weight);
    }

    /// Takes rows `[rows][dim]` of every rank in.
    ///
    /// # Errors
    /// The device was lost.
    pub fn update_over(&mut self, ranks: &Ranks, values: &Array, rows: usize) -> Result<()> {
        if ranks.is_alone() {
            self.update(values, rows);
            return Ok(());
        }
        let mut own = self.clone();
        own.take_in(values, rows, 1.0);
        let (own, mut moments) = (own.on_host()?, self.on_host()?.moments.host().to_vec());
        // Differences from the old mean, and their squares.
        let shifts = own.mean().iter().zip(&moments);
        let shifts: Vec<f32> = shifts.map(|(own, old)| own - old).collect();
        let squares = own.moments()[self.dim..].iter().zip(&shifts);
        let squares = squares.map(|(variance, shift)| variance + shift * shift);
        let mut sums: Vec<f32> = shifts.iter().copied().chain(squares).collect();
        ranks.sum(&mut sums);
        let weight = self.weigh(rows * ranks.count());
        for column in 0..self.dim {
            let mean = |at: usize| f64::from(sums[at]) / ranks.count() as f64;
            let (shift, square) = (mean(column), mean(self.dim + column));
            mix(&mut moments, column, shift, square, weight);
        }
        self.moments = Array::from_slice(&self.device, &moments);
        Ok(())
    }

    /// The part that so many new rows have in all.
    fn weigh(&mut self, rows: usize) -> f64 {
        self.count += rows as f64;
        rows as f64 / self.count
    }

    fn take_in(&mut self, values: &Array, rows: usize, weight: f64) {
        match &self.device {
            Device::Cpu => {
                let values = &values.host()[..rows * self.dim];
                take_in(self.moments.host_mut(), values, weight);
            }
            #[cfg(feature = "gpu")]
            Device::Gpu(gpu) => moments::take_in(gpu, &mut self.moments, values, rows, weight),
            #[cfg(not(feature = "gpu"))]
            Device::Gpu(_) => {}
        }
    }

    /// Writes the normalised rows `[rows][dim]` of `from`, from the index `from_at` on, to `to`, from
    /// `to_at` on.
    pub fn normalize(
        &self,
        from: &Array,
        from_at: usize,
        to: &mut Array,
        to_at: usize,
        rows: usize,
    ) {
        let count = rows * self.dim;
        match &self.device {
            Device::Cpu => {
                let to = &mut to.host_mut()[to_at..][..count];
                to.copy_from_slice(&from.host()[from_at..][..count]);
                normalize(self.moments.host(), to);
            }
            #[cfg(feature = "gpu")]
            Device::Gpu(gpu) => {
                let values =
                    moments::normalized(gpu, &self.moments, from, from_at, rows, [MIN_STD, CLIP]);
                super::gpu::tensors::write(gpu, values, to, to_at);
            }
            #[cfg(not(feature = "gpu"))]
            Device::Gpu(_) => {}
        }
    }

    /// Normalises the rows `[rows][dim]` that `values` begins with.
    pub fn normalize_in_place(&self, values: &mut Array, rows: usize) {
        match &self.device {
            Device::Cpu => normalize(
                self.moments.host(),
                &mut values.host_mut()[..rows * self.dim],
            ),
            Device::Gpu(_) => {
                let from = values.clone();
                self.normalize(&from, 0, values, 0, rows);
            }
        }
    }

    /// Normalises one row by moments in host memory.
    pub fn normalize_row(&self, row: &mut [f32]) {
        let (means, variances) = self.moments.host().split_at(self.dim);
        for ((value, mean), variance) in row.iter_mut().zip(means).zip(variances) {
            *value = normalized(*value, *mean, inv_std(*variance));
        }
    }

    /// Moments in host memory of rows that go on behind these, as if only few rows had been seen: the new
    /// columns are soon known.
    pub fn widened(&self, dim: usize) -> RunningMeanStd {
        const FEW: f64 = 10_000.0;
        let (means, variances) = self.moments.host().split_at(self.dim);
        let more = dim - self.dim;
        let moments = [means, &vec![0.0; more], variances, &vec![1.0; more]].concat();
        RunningMeanStd {
            device: Device::Cpu,
            moments: Array::Host(moments),
            dim,
            count: self.count.min(FEW),
        }
    }

    /// Means, then variances, `[2][dim]`, of moments in host memory.
    pub fn moments(&self) -> &[f32] {
        self.moments.host()
    }

    /// Means `[dim]`, of moments in host memory.
    pub fn mean(&self) -> &[f32] {
        &self.moments()[..self.dim]
    }

    /// What numbers less their means are multiplied by, `[dim]`, of moments in host memory.
    pub fn inv_std(&self) -> Vec<f32> {
        let variances = &self.moments()[self.dim..];
        variances
            .iter()
            .map(|&variance| inv_std(variance))
            .collect()
    }

    /// A copy of the moments in host memory.
    ///
    /// # Errors
    /// The device was lost.
    pub fn on_host(&self) -> Result<RunningMeanStd> {
        Ok(RunningMeanStd {
            moments: Array::Host(self.moments.read(&self.device)?),
            device: Device::Cpu,
            ..*self
        })
    }

    /// A copy on `device` of moments in host memory.
    pub fn on(&self, device: &Device) -> RunningMeanStd {
        RunningMeanStd {
            moments: Array::from_slice(device, self.moments.host()),
            device: device.clone(),
            ..*self
        }
    }

    /// Saves the moments.
    ///
    /// # Errors
    /// The device was lost.
    pub fn save(&self, to: &mut Section) -> Result<()> {
        to.put_array("normalizer.count", &[self.count]);
        to.put_array("normalizer.moments", &self.moments.read(&self.device)?);
        Ok(())
    }

    /// Reads moments of rows of `dim` numbers into host memory.
    ///
    /// # Errors
    /// They are missing or damaged.
    pub fn load(from: &mut Section, dim: usize) -> Result<RunningMeanStd, SectionError> {
        let count: Vec<f64> = from.take_array("normalizer.count", 1)?;
        let moments = from.take_finite("normalizer.moments", 2 * dim)?;
        if count[0].is_nan()
            || count[0] < 0.0
            || moments[dim..].iter().any(|&variance| variance < 0.0)
        {
            let message = "its normalizer has a negative number of rows or variance";
            return Err(SectionError(message.to_string()));
        }
        Ok(RunningMeanStd {
            device: Device::Cpu,
            moments: Array::Host(moments),
            dim,
            count: count[0],
        })
    }
}

/// Mixes the moments of rows in (Chan, Golub and LeVeque 1979), at a `weight` of their part of all rows.
fn take_in(moments: &mut [f32], rows: &[f32], weight: f64) {
    let dim = moments.len() / 2;
    let means = &moments[..dim];
    let count = (rows.len() / dim) as f64;
    // Sums of differences from the old mean, and of their squares.
    let chunk = |rows: &[f32]| {
        let mut sums = vec![[0.0f64; 2]; dim];
        for row in rows.chunks_exact(dim) {
            for ((sum, value), mean) in sums.iter_mut().zip(row).zip(means) {
                let difference = f64::from(value - mean);
                sum[0] += difference;
                sum[1] += difference * difference;
            }
        }
        sums
    };
    let chunks: Vec<Vec<[f64; 2]>> = rows.par_chunks(CHUNK_ROWS * dim).map(chunk).collect();
    for column in 0..dim {
        let [sum, squares] = chunks.iter().fold([0.0; 2], |sum, chunk| {
            [sum[0] + chunk[column][0], sum[1] + chunk[column][1]]
        });
        mix(moments, column, sum / count, squares / count, weight);
    }
}

/// Mixes in what some rows of a column have as mean difference from the old mean, and as mean square of it.
fn mix(moments: &mut [f32], column: usize, shift: f64, square: f64, weight: f64) {
    let (means, variances) = moments.split_at_mut(moments.len() / 2);
    let variance = square - shift * shift;
    let mixed = (1.0 - weight) * f64::from(variances[column]) + weight * variance;
    variances[column] = (mixed + weight * (1.0 - weight) * shift * shift).max(0.0) as f32;
    means[column] = (f64::from(means[column]) + weight * shift) as f32;
}

fn normalize(moments: &[f32], rows: &mut [f32]) {
    let (means, variances) = moments.split_at(moments.len() / 2);
    let inv_std: Vec<f32> = variances
        .iter()
        .map(|&variance| inv_std(variance))
        .collect();
    for row in rows.chunks_exact_mut(means.len()) {
        for ((value, mean), inv_std) in row.iter_mut().zip(means).zip(&inv_std) {
            *value = normalized(*value, *mean, *inv_std);
        }
    }
}

fn inv_std(variance: f32) -> f32 {
    1.0 / variance.sqrt().max(MIN_STD)
}

fn normalized(value: f32, mean: f32, inv_std: f32) -> f32 {
    ((value - mean) * inv_std).clamp(-CLIP, CLIP)
}
