//! The networks on the CPU, in floating-point operations a second: `cargo bench --bench network`.
//! Learning takes three times the operations of an answer.

use burn::tensor::{Device as Tensors, Tensor};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use footwork::gpu::Device;
use footwork::motion::features::TRAJECTORY_DIM;
use footwork::rl::rollout::Rollout;
use footwork::rl::ppo::update::Learner;
use footwork::nn::tensors::read;
use footwork::train::config::{Config, Kind, Preset};

/// Samples of an answer and of a gradient step.
const BATCH: usize = 512;
const SAMPLES: usize = 4 * BATCH;

fn network(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("network");
    for (name, kind, preset) in [
        ("plane", Kind::Plane, Preset::Fast),
        ("obstacles", Kind::Obstacles, Preset::Fast),
        ("obstacles, the paper's", Kind::Obstacles, Preset::Paper),
    ] {
        let config = Config::preset(kind, preset);
        let (mut ppo, width) = (config.ppo, config.task.width());
        (ppo.epochs, ppo.minibatch) = (1, BATCH);
        let device = Tensors::flex();
        let mut learner = Learner::new(&ppo, width, &Device::Cpu, 1).expect("a network that fits");
        let operations = learner.shape.operations() as u64;
        let rollout = rollout(width, &device);
        for threads in [1, 2] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            let pool = pool.build().expect("threads start");
            let observation = rollout.observation.clone().narrow(0, 0, BATCH);
            let policy = learner.policy();
            group.throughput(Throughput::Elements(operations * BATCH as u64));
            group.bench_function(format!("{name}, answers, threads: {threads}"), |b| {
                b.iter(|| {
                    pool.install(|| {
                        (
                            policy.mean(observation.clone()),
                            policy.value(observation.clone()),
                        )
                    })
                });
            });
            group.throughput(Throughput::Elements(3 * operations * SAMPLES as u64));
            group.bench_function(format!("{name}, learning, threads: {threads}"), |b| {
                b.iter(|| pool.install(|| read(learner.update(&rollout, &ppo))));
            });
        }
    }
    group.finish();
}

fn rollout(width: usize, device: &Tensors) -> Rollout {
    let row = |width| {
        let column = Tensor::arange(0..SAMPLES as i64, device).float();
        let column = column.mul_scalar(0.7).sin();
        column.unsqueeze_dim::<2>(1).repeat_dim(1, width)
    };
    let scalar = || row(1).squeeze_dim::<1>(1);
    Rollout {
        observation: row(width),
        action: row(TRAJECTORY_DIM),
        mean: row(TRAJECTORY_DIM).mul_scalar(0.9),
        log_prob: scalar().sub_scalar(12.0),
        value: scalar(),
        advantage: scalar(),
        target: scalar(),
        log_std: Tensor::zeros([TRAJECTORY_DIM], device),
        act_s: 0.0,
        simulate_s: 0.0,
    }
}

criterion_group!(benches, network);
criterion_main!(benches);
