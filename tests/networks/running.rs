//! The observations' running moments, and sums of long columns.

use super::*;
use footwork::nn::RunningMeanStd;
use footwork::nn::gpu::tensors::column_sums;

const DIM: usize = 3;

/// Rows far from zero, whose last column is constant.
fn rows(count: usize, stream: u32) -> Vec<f32> {
    let noise = normal(count * DIM, stream);
    let rows = noise.chunks_exact(DIM);
    rows.flat_map(|row| [3.0 * row[0] + 100.0, 0.5 * row[1] - 2.0, 4.0])
        .collect()
}

/// Against the moments of all rows at once.
#[test]
fn running_moments_are_those_of_all_rows() {
    let parts = [rows(500, 1), rows(1, 2), rows(3000, 3)];
    let all = parts.concat();
    let moment = |column: usize| {
        let values = all.iter().skip(column).step_by(DIM).map(|&v| f64::from(v));
        let count = (all.len() / DIM) as f64;
        let mean = values.clone().sum::<f64>() / count;
        let square = values
            .map(|value| (value - mean) * (value - mean))
            .sum::<f64>();
        (mean, (square / count).sqrt())
    };
    for device in [Device::Cpu, lavapipe()] {
        let mut running = RunningMeanStd::new(&device, DIM);
        for part in &parts {
            let rows = part.len() / DIM;
            running.update(&Array::from_slice(&device, part), rows);
        }
        let row = [103.0, -7.9, 4.0, 100.0, -2.0, 4.0];
        let from = Array::from_slice(&device, &[vec![0.0], row.to_vec()].concat());
        let mut to = Array::from_slice(&device, &[7.0; 8]);
        running.normalize(&from, 1, &mut to, 1, 2);
        let got = to.read(&device).expect("the device is there");
        assert_eq!([got[0], got[7]], [7.0; 2]);
        for (i, &value) in row.iter().enumerate() {
            let (mean, std) = moment(i % DIM);
            let want = ((f64::from(value) - mean) / std.max(1e-2)).clamp(-10.0, 10.0);
            let got = f64::from(got[1 + i]);
            assert!((got - want).abs() < 2e-3, "{i}: {got} instead of {want}");
        }
        let mut in_place = Array::from_slice(&device, &row);
        running.normalize_in_place(&mut in_place, 2);
        assert_eq!(in_place.read(&device).expect("there"), got[1..7]);
        let there = running.on_host().expect("the device is there").on(&device);
        there.normalize(&from, 1, &mut to, 1, 2);
        assert_eq!(to.read(&device).expect("there"), got);
    }
}

/// burn's own sum of a column leaves out most of a long one on lavapipe.
#[test]
fn columns_of_any_length_are_summed_whole() {
    let Device::Gpu(gpu) = lavapipe() else {
        unreachable!("lavapipe is a GPU")
    };
    for length in [1, 511, 512, 1000, 65_534, 65_536, 226_553, 3_000_000] {
        let ones = Array::from_slice(&lavapipe(), &vec![1.0; 2 * length]);
        let ones = footwork::gpu::tensor::from_buffer(&gpu, ones.buffer(), [length, 2]);
        let sums = footwork::gpu::tensor::to_buffer(column_sums(ones));
        let sums = sums.read(&gpu).expect("the device is there");
        assert_eq!(sums, [length as f32; 2]);
    }
}
