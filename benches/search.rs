//! Exact search, in queries a second: one query on one core, and a batch on all of them.
//!
//! `cargo bench --bench search` uses the synthetic motion; with `FOOTWORK_DATA` a database file or
//! a folder of BVH files. Queries are the pose of one random frame with the future of another, and
//! noise on top, as a policy at the start of training asks.

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use footwork::kernels::rng::{gaussian, index_below, random4};
use footwork::kernels::search::search_exact;
use footwork::motion::database::Database;
use footwork::motion::features::{FEATURE_DIM, POSE_DIM, ROW_STRIDE};
use footwork::motion::normalise::Weights;
use footwork::matching::{Index, MEMORY};
use footwork::train::data;
use std::hint::black_box;
use std::path::PathBuf;
use std::time::Instant;

fn queries(database: &Database, noise: f32, count: u32) -> (Vec<u32>, Vec<[f32; ROW_STRIDE]>) {
    let candidates = &database.candidates;
    let pick = |i, stream| {
        let bits = random4(1, i, 0, stream)[0];
        candidates[index_below(bits, candidates.len() as u32) as usize]
    };
    let query = |i| {
        let (pose, future) = (pick(i, 0), pick(i, 1));
        let query = std::array::from_fn(|d| match d {
            0..POSE_DIM => database.features[pose as usize][d],
            POSE_DIM..FEATURE_DIM => {
                database.features[future as usize][d] + noise * gaussian(random4(2, i, d as u32, 0))
            }
            _ => 1.0,
        });
        (pose, query)
    };
    (0..count).map(query).unzip()
}

fn search(criterion: &mut Criterion) {
    let path = std::env::var_os("FOOTWORK_DATA").map(PathBuf::from);
    let (database, _) =
        data::load(path.as_deref(), Weights::PAPER).expect("the data of FOOTWORK_DATA");
    let rows = database.rows();
    // Not the database's own, which may have been read from a file.
    let begin = Instant::now();
    let index = Index::build(&database.features, &database.candidates, MEMORY);
    eprintln!(
        "{} candidates, index {:.1} MB, built in {:.2} s",
        rows.len(),
        index.bytes() as f64 / 1e6,
        begin.elapsed().as_secs_f64()
    );
    let mut group = criterion.benchmark_group("search");
    for (name, noise) in [("calm", 0.1), ("noisy", 1.0), ("wild", 2.6)] {
        let (frames, queries) = queries(&database, noise, 4096);
        group.throughput(Throughput::Elements(queries.len() as u64));
        group.bench_function(format!("indexed, one core, {name}"), |b| {
            b.iter(|| {
                let each = frames.iter().zip(&queries);
                each.map(|(&frame, query)| u64::from(index.nearest(frame, query).index))
                    .sum::<u64>()
            });
        });
        group.bench_function(format!("indexed, all cores, {name}"), |b| {
            b.iter_batched_ref(
                || vec![0; queries.len()],
                |found| index.nearest_all(&frames, black_box(&queries), found),
                BatchSize::LargeInput,
            );
        });
    }
    let (_, queries) = queries(&database, 1.0, 16);
    group.throughput(Throughput::Elements(queries.len() as u64));
    group.bench_function("plain, one core", |b| {
        let params = search_exact::Params {
            count: 16,
            candidates: rows.len() as u32,
            block: 64,
            max_norm: 0.0,
        };
        let mut matched = [0; 16];
        b.iter(|| search_exact::twin(&rows, black_box(&queries), &[], &mut matched, &params));
    });
    group.finish();
}

criterion_group! { name = benches; config = Criterion::default().sample_size(10); targets = search }
criterion_main!(benches);
