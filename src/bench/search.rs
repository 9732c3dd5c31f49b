//! The search, among all rows and by the index, in databases of a few thousand frames to a million.
//!
//! A query is the pose of one frame with the future of another, and noise of deviation 1 on that: what
//! a policy asks while it learns.

use super::roofline::Ceiling;
use super::clock::{TOO_LONG_S, Work, seconds};
use super::data::Motion;
use super::bench_device::Place;
use super::{Item, Record};
use crate::gpu::{Buffer, Device};
use crate::kernels::rng::{gaussian, index_below, random4};
use crate::kernels::search::search_exact;
use crate::motion::database::Database;
use crate::motion::features::{FEATURE_DIM, POSE_DIM, ROW_STRIDE};
use crate::matching::Index;
use crate::matching::gpu::brute_force::Brute;
use crate::matching::gpu::indexed::Indexed;
use anyhow::Result;

const SIZES: [usize; 5] = [4096, 16_384, 65_536, 262_144, 1_048_576];
/// Queries of a batch; the plain search on the CPU, an oracle, gets fewer.
const QUERIES: usize = 8192;
const FEW: usize = 16;
const NOISE: f32 = 1.0;

pub fn measure(motion: &Motion, places: &[(&Place, &Ceiling)], record: &mut Record) -> Result<()> {
    // Seconds that the last size took, by place and variant.
    let mut last = vec![[0.0; 2]; places.len()];
    for size in SIZES {
        (record.tell)(&format!("an index of {size} frames"));
        let database = motion.of(size)?;
        let case = Case::new(&database);
        for (&(place, ceiling), last) in places.iter().zip(&mut last) {
            for (brute, last) in [true, false].into_iter().zip(last) {
                let item = case.item(place, brute);
                (record.tell)(&format!(
                    "{}: search, {} of {size}",
                    place.name(),
                    item.variant
                ));
                if 4.0 * *last > TOO_LONG_S {
                    continue;
                }
                *last = case.seconds(place, brute)?;
                record.add(place, ceiling, item, *last);
            }
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
    fn new(database: &Database) -> Self {
        let (shown, queries) = (0..QUERIES as u32).map(|i| query(database, i)).unzip();
        let memory = crate::matching::MEMORY;
        Case {
            rows: database.rows(),
            index: Index::build(&database.features, &database.candidates, memory),
            shown,
            queries,
        }
    }

    fn item(&self, place: &Place, brute: bool) -> Item<'static> {
        let rows = self.rows.len() * ROW_STRIDE * size_of::<f32>();
        let few = brute && matches!(place.device, Device::Cpu);
        let operations = if brute {
            2 * ROW_STRIDE * self.rows.len()
        } else {
            0
        };
        Item {
            stage: "search",
            variant: if brute { "brute" } else { "indexed" },
            frames: self.rows.len(),
            envs: 0,
            batch: if few { FEW } else { QUERIES },
            bytes: Some(if brute { rows } else { self.index.bytes() }),
            work: Work {
                bytes: 0.0,
                operations: operations as f64,
            },
        }
    }

    fn seconds(&self, place: &Place, brute: bool) -> Result<f64> {
        match &place.device {
            Device::Cpu => place.inside(|| self.on_cpu(place, brute)),
            Device::Gpu(gpu) => {
                let queries = Buffer::from_slice(gpu, self.queries.as_flattened());
                if brute {
                    let search = Brute::new(gpu, &self.rows, QUERIES);
                    return seconds(place, || {
                        search.nearest(gpu, &queries);
                        Ok(())
                    });
                }
                let search = Indexed::new(gpu, &self.index, QUERIES);
                let shown = Buffer::from_slice(gpu, &self.shown);
                seconds(place, || {
                    search.nearest(gpu, &shown, &queries);
                    Ok(())
                })
            }
        }
    }

    fn on_cpu(&self, place: &Place, brute: bool) -> Result<f64> {
        let mut found = vec![0; QUERIES];
        seconds(place, || {
            match brute {
                true => self.plainly(&mut found),
                false => self
                    .index
                    .nearest_all(&self.shown, &self.queries, &mut found),
            }
            Ok(())
        })
    }

    fn plainly(&self, found: &mut [u32]) {
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

/// The frame shown, and what is asked for.
fn query(database: &Database, number: u32) -> (u32, [f32; ROW_STRIDE]) {
    let candidates = &database.candidates;
    let pick = |stream| {
        let bits = random4(1, number, 0, stream)[0];
        candidates[index_below(bits, candidates.len() as u32) as usize]
    };
    let (pose, future) = (pick(0), pick(1));
    let noise = |d: usize| NOISE * gaussian(random4(2, number, d as u32, 0));
    let query = std::array::from_fn(|d| match d {
        0..POSE_DIM => database.features[pose as usize][d],
        POSE_DIM..FEATURE_DIM => database.features[future as usize][d] + noise(d),
        _ => 1.0,
    });
    (pose, query)
}
