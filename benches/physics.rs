//! Steps of simulated humanoids: the CPU's on all cores, or as many as `RAYON_NUM_THREADS` says, and every
//! launch of lavapipe's. `FOOTWORK_ENVS` sets the number of environments (256).

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use footwork::physics::simulator::{SUBSTEPS, SolverOptions};
use footwork::physics::scenes;
use footwork::gpu::{Device, Gpu};
use footwork::env::humanoid::batch::{self, GpuSimulatorBatch, SimulatorBatch, SimulatorBatchConfig};
use std::sync::Arc;
use std::time::{Duration, Instant};

fn config() -> SimulatorBatchConfig {
    let envs = std::env::var("FOOTWORK_ENVS").ok();
    let envs = envs.and_then(|envs| envs.parse().ok());
    let model = Arc::new(scenes::humanoid());
    SimulatorBatchConfig {
        options: SolverOptions::fast(&model),
        envs: envs.unwrap_or(256),
        seed: 1,
        force_pairs: Vec::new(),
        model,
    }
}

/// Until some have fallen, so that there are contacts of all kinds.
fn warm(worlds: &mut dyn SimulatorBatch) {
    for _ in 0..45 {
        worlds.draw_targets(0.5);
        worlds.step();
    }
}

/// One whole step, of which one launch is timed: repeated by itself it would find nothing left to do.
fn step(worlds: &GpuSimulatorBatch, timed: &str) -> Duration {
    let wait = || worlds.counters().expect("the device is there");
    let mut taken = Duration::ZERO;
    for (name, launch) in GpuSimulatorBatch::LAUNCHES {
        if name != timed {
            launch(worlds, true);
            continue;
        }
        wait();
        let began = Instant::now();
        launch(worlds, true);
        wait();
        taken = began.elapsed();
    }
    taken
}

fn physics(criterion: &mut Criterion) {
    let config = config();
    let mut group = criterion.benchmark_group("physics");
    group.sample_size(10);
    group.throughput(Throughput::Elements((config.envs * SUBSTEPS) as u64));
    let mut worlds = batch::open(&Device::Cpu, &config).expect("the humanoid fits");
    warm(worlds.as_mut());
    group.bench_function(
        BenchmarkId::new("cpu", rayon::current_num_threads()),
        |bencher| {
            bencher.iter(|| {
                worlds.draw_targets(0.5);
                worlds.step();
            });
        },
    );
    let gpu = Gpu::lavapipe().expect("a software adapter");
    let mut worlds = GpuSimulatorBatch::new(&config, &gpu).expect("the humanoid fits");
    warm(&mut worlds);
    group.throughput(Throughput::Elements(config.envs as u64));
    for (timed, _) in GpuSimulatorBatch::LAUNCHES {
        group.bench_function(BenchmarkId::new("lavapipe", timed), |bencher| {
            bencher.iter_custom(|steps| (0..steps).map(|_| step(&worlds, timed)).sum());
        });
    }
    group.finish();
}

criterion_group!(benches, physics);
criterion_main!(benches);
