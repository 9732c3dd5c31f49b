//! Both tasks' environments alone, in steps a second: random actions, no networks. Obstacles are on
//! the hardest level, hits, collisions and maps included.
//!
//! `cargo bench --bench world` uses the synthetic motion; with `FOOTWORK_DATA` a database file or
//! a folder of BVH files. Lavapipe and a real GPU are measured where there is one.

use burn::tensor::Tensor;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use footwork::gpu::{Choice, Device};
use footwork::motion::features::TRAJECTORY_DIM;
use footwork::motion::normalise::Weights;
use footwork::train::data;
use footwork::env::locomotion::{self, LEVELS, Obstacles, Plane, Setup, Task};
use std::path::PathBuf;
use std::sync::Arc;

fn world(criterion: &mut Criterion) {
    let path = std::env::var_os("FOOTWORK_DATA").map(PathBuf::from);
    let (database, _) =
        data::load(path.as_deref(), Weights::PAPER).expect("the data of FOOTWORK_DATA");
    let database = Arc::new(database);
    let tasks = [
        Task::Plane(Plane::default()),
        Task::Obstacles(Obstacles::PRINTED),
    ];
    let mut group = criterion.benchmark_group("world");
    for choice in [Choice::Cpu, Choice::Lavapipe, Choice::Gpu] {
        let Ok(device) = Device::open(choice) else {
            eprintln!("no {choice:?} here");
            continue;
        };
        for (task, envs) in tasks
            .iter()
            .flat_map(|&task| [256, 2048].map(|envs| (task, envs)))
        {
            let setup = Setup {
                task,
                envs,
                horizon: 16,
                seed: 1,
                level: LEVELS - 1,
            };
            let mut world = locomotion::open(&device, &database, &setup);
            let tensors = device.tensors();
            let mean = Tensor::<2>::zeros([envs, TRAJECTORY_DIM], &tensors);
            let log_std = Tensor::<1>::zeros([TRAJECTORY_DIM], &tensors);
            group.throughput(Throughput::Elements(envs as u64 * 16));
            group.bench_function(
                format!("{}, {choice:?}, {envs} environments", task.name()),
                |b| {
                    b.iter(|| {
                        for _ in 0..16 {
                            let (action, _) = world.act(mean.clone(), log_std.clone());
                            world.step(action);
                            world.observe();
                        }
                        device.sync().expect("the device is there");
                    });
                },
            );
        }
    }
    group.finish();
}

criterion_group! { name = benches; config = Criterion::default().sample_size(10); targets = world }
criterion_main!(benches);
