//! Steps of simulated humanoids: the CPU's on all cores, or as many as `RAYON_NUM_THREADS` says, and every
//! launch of lavapipe's. `FOOTWORK_WORLDS` sets the number of worlds (256).

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use footwork::physics::simulator::{SUBSTEPS, Settings};
use footwork::physics::scenes;
use footwork::gpu::{Device, Gpu};
use footwork::env::humanoid::gpu::GpuSimulation;
use footwork::env::humanoid::{Setup, Simulation};
use std::sync::Arc;
use std::time::{Duration, Instant};

fn setup() -> Setup {
    let worlds = std::env::var("FOOTWORK_WORLDS")
        .ok()
        .and_then(|worlds| worlds.parse().ok());
    let model = Arc::new(scenes::one());
    Setup {
        settings: Settings::training(&model),
        envs: worlds.unwrap_or(256),
        seed: 1,
        watched: Vec::new(),
        model,
    }
}

/// Until some have fallen, so that there are contacts of all kinds.
fn warm(simulation: &mut dyn Simulation) {
    for _ in 0..45 {
        simulation.explore(0.5);
        simulation.step();
    }
}

/// One whole step, of which one launch is timed: repeated by itself it would find nothing left to do.
fn step(simulation: &GpuSimulation, timed: &str) -> Duration {
    let wait = || simulation.tallies().expect("the device is there");
    let mut taken = Duration::ZERO;
    for (name, launch) in GpuSimulation::LAUNCHES {
        if name != timed {
            launch(simulation, true);
            continue;
        }
        wait();
        let began = Instant::now();
        launch(simulation, true);
        wait();
        taken = began.elapsed();
    }
    taken
}

fn physics(criterion: &mut Criterion) {
    let setup = setup();
    let mut group = criterion.benchmark_group("physics");
    group.sample_size(10);
    group.throughput(Throughput::Elements((setup.envs * SUBSTEPS) as u64));
    let mut simulation = setup.on(&Device::Cpu).expect("the humanoid fits");
    warm(simulation.as_mut());
    group.bench_function(
        BenchmarkId::new("cpu", rayon::current_num_threads()),
        |bencher| {
            bencher.iter(|| {
                simulation.explore(0.5);
                simulation.step();
            });
        },
    );
    let gpu = Gpu::lavapipe().expect("a software adapter");
    let mut simulation = GpuSimulation::new(&setup, &gpu).expect("the humanoid fits");
    warm(&mut simulation);
    group.throughput(Throughput::Elements(setup.envs as u64));
    for (timed, _) in GpuSimulation::LAUNCHES {
        group.bench_function(BenchmarkId::new("lavapipe", timed), |bencher| {
            bencher.iter_custom(|steps| (0..steps).map(|_| step(&simulation, timed)).sum());
        });
    }
    group.finish();
}

criterion_group!(benches, physics);
criterion_main!(benches);
