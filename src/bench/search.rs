//! The search, among all rows and by the index, in databases of a few thousand frames to a million.
//!
//! A query is the pose of one frame with the future of another, and noise of standard deviation 1 on
//! that: the queries of a policy while it learns. In the whole database also with less and with more noise,
//! and one query at a time on one core.

use super::bench_device::BenchDevice;
use super::clock::{MAX_CALL_S, seconds};
use super::data::BenchData;
use super::recorder::{Recorder, Workload};
use super::roofline::{ItemCost, Roofline};
use crate::gpu::{Buffer, Device};
use crate::kernels::rng::{gaussian, index_below, random4};
use crate::kernels::search::search_exact;
use crate::matching::gpu::brute_force::BruteForceSearch;
use crate::matching::gpu::indexed::IndexedSearch;
use crate::matching::{DEFAULT_TABLE_BYTES, Index};
use crate::motion::database::Database;
use crate::motion::features::{FEATURE_DIM, POSE_DIM, ROW_STRIDE};
use anyhow::Result;

const SIZES: [usize; 5] = [4096, 16_384, 65_536, 262_144, 1_048_576];
/// Queries of a batch; the search over all rows on the CPU, an oracle, gets fewer.
const QUERIES: usize = 8192;
const FEW: usize = 16;
/// Standard deviation of the noise on queries.
const NOISE: f32 = 1.0;
/// That of a trained policy, of one that learns, and of an untrained one.
const NOISES: [(&str, f32); 3] = [
    ("indexed, calm", 0.1),
    ("indexed, noisy", NOISE),
    ("indexed, wild", 2.6),
];

/// Measures all devices, size by size, so that each database and index is built once.
pub fn measure(
    data: &BenchData,
    devices: &[(&BenchDevice, &Roofline)],
    record: &mut Recorder,
) -> Result<()> {
    // Seconds that the last size took, by device and variant.
    let mut last = vec![[0.0; 2]; devices.len()];
    for size in SIZES {
        (record.tell)(&format!("an index of {size} frames"));
        let case = Case::new(&data.with_candidates(size)?, NOISE);
        for (&(on, roofline), last) in devices.iter().zip(&mut last) {
            for (brute, last) in [true, false].into_iter().zip(last) {
                if 4.0 * *last > MAX_CALL_S {
                    continue;
                }
                let variant = if brute { "brute" } else { "indexed" };
                (record.tell)(&format!("{}: search, {variant} of {size}", on.name()));
                *last = case.seconds(on, brute)?;
                record.add(on, roofline, case.workload(on, variant), *last);
            }
        }
    }
    whole(data, devices, record)
}

/// Measures queries of the whole database.
fn whole(
    data: &BenchData,
    devices: &[(&BenchDevice, &Roofline)],
    record: &mut Recorder,
) -> Result<()> {
    for (variant, noise) in NOISES {
        let case = Case::new(&data.database, noise);
        for &(on, roofline) in devices {
            (record.tell)(&format!("{}: search, {variant}", on.name()));
            let time = case.seconds(on, false)?;
            record.add(on, roofline, case.workload(on, variant), time);
        }
    }
    let case = Case::new(&data.database, NOISE);
    for &(on, roofline) in devices {
        if matches!(on.device, Device::Cpu) && on.threads == 1 {
            let time = on.install(|| case.one_by_one(on))?;
            record.add(on, roofline, case.workload(on, "indexed, one by one"), time);
        }
    }
    Ok(())
}

struct Case {
    rows: Vec<[f32; ROW_STRIDE]>,
    index: Index,
    shown: Vec<u32>,
    queries: Vec<[f32; ROW_STRIDE]>,
}

impl Case {
    fn new(database: &Database, noise: f32) -> Self {
        let numbers = 0..QUERIES as u32;
        let (shown, queries) = numbers.map(|i| query(database, noise, i)).unzip();
        Case {
            rows: database.rows(),
            index: Index::build(
                &database.features,
                &database.candidates,
                DEFAULT_TABLE_BYTES,
            ),
            shown,
            queries,
        }
    }

    fn workload<'a>(&self, on: &BenchDevice, variant: &'a str) -> Workload<'a> {
        let brute = variant == "brute";
        let few = brute && matches!(on.device, Device::Cpu);
        let operations = if brute {
            2 * ROW_STRIDE * self.rows.len()
        } else {
            0
        };
        Workload {
            stage: "search",
            variant,
            frames: self.rows.len(),
            envs: 0,
            batch: if few { FEW } else { QUERIES },
            bytes: Some(match brute {
                true => size_of_val(&self.rows[..]),
                false => self.index.bytes(),
            }),
            cost: ItemCost {
                bytes: 0.0,
                operations: operations as f64,
            },
        }
    }

    fn seconds(&self, on: &BenchDevice, brute: bool) -> Result<f64> {
        match &on.device {
            Device::Cpu => on.install(|| self.on_cpu(on, brute)),
            Device::Gpu(gpu) => {
                let queries = Buffer::from_slice(gpu, self.queries.as_flattened());
                if brute {
                    let search = BruteForceSearch::new(gpu, &self.rows, QUERIES);
                    return seconds(on, || {
                        search.nearest(gpu, &queries);
                        Ok(())
                    });
                }
                let search = IndexedSearch::new(gpu, &self.index, QUERIES);
                let shown = Buffer::from_slice(gpu, &self.shown);
                seconds(on, || {
                    search.nearest(gpu, &shown, &queries);
                    Ok(())
                })
            }
        }
    }

    fn on_cpu(&self, on: &BenchDevice, brute: bool) -> Result<f64> {
        let mut found = vec![0; QUERIES];
        seconds(on, || {
            match brute {
                true => self.brute_force(&mut found),
                false => self
                    .index
                    .nearest_all(&self.shown, &self.queries, &mut found),
            }
            Ok(())
        })
    }

    fn one_by_one(&self, on: &BenchDevice) -> Result<f64> {
        seconds(on, || {
            for (&frame, query) in self.shown.iter().zip(&self.queries) {
                std::hint::black_box(self.index.nearest(frame, query));
            }
            Ok(())
        })
    }

    fn brute_force(&self, found: &mut [u32]) {
        use rayon::prelude::*;
        let params = search_exact::Params {
            count: 1,
            candidates: self.rows.len() as u32,
            block: 64,
            max_norm: 0.0,
        };
        let each = self.queries[..FEW]
            .par_chunks(1)
            .zip(found.par_chunks_mut(1));
        each.for_each(|(query, found)| search_exact::twin(&self.rows, query, &[], found, &params));
    }
}

/// The frame whose pose a query has, and the query.
fn query(database: &Database, noise: f32, number: u32) -> (u32, [f32; ROW_STRIDE]) {
    let candidates = &database.candidates;
    let pick = |stream| {
        let bits = random4(1, number, 0, stream)[0];
        candidates[index_below(bits, candidates.len() as u32) as usize]
    };
    let (pose, future) = (pick(0), pick(1));
    let noise = |d: usize| noise * gaussian(random4(2, number, d as u32, 0));
    let query = std::array::from_fn(|d| match d {
        0..POSE_DIM => database.features[pose as usize][d],
        POSE_DIM..FEATURE_DIM => database.features[future as usize][d] + noise(d),
        _ => 1.0,
    });
    (pose, query)
}
