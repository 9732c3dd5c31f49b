//! The networks on the CPU, in floating-point operations a second: `cargo bench --bench network`. A
//! gradient takes three times the operations of an output.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use footwork::gpu::{Array, Device};
use footwork::kernels::rng::{gaussian, random4};
use footwork::nn::layer::{Activation, Convolution};
use footwork::nn::observation::ObservationSpec;
use footwork::nn::{ActorCritic, Adam, Engine, NetworkConfig, Rows};
use footwork::rl::ppo::loss::{LossCoefficients, PpoLoss, SUMS};

/// A network to measure.
struct Case {
    name: &'static str,
    observation: ObservationSpec,
    action: usize,
    config: NetworkConfig,
    /// Rows of a minibatch.
    rows: usize,
}

fn dense(name: &'static str, vector: usize, hidden: &[usize], action: usize, rows: usize) -> Case {
    Case {
        name,
        observation: ObservationSpec { vector, grid: None },
        action,
        config: NetworkConfig {
            convolutions: Vec::new(),
            encoder_hidden: Vec::new(),
            hidden: hidden.to_vec(),
            activation: Activation::Tanh,
        },
        rows,
    }
}

/// As among obstacles, with the first convolution at a stride.
fn maps(name: &'static str, stride: usize) -> Case {
    let mut case = dense(name, 17, &[256, 128], 12, 512);
    case.observation.grid = Some([16, 16, 2]);
    let convolution = |filters, size, stride| Convolution {
        filters,
        size,
        stride,
    };
    case.config.convolutions = vec![convolution(16, 4, stride), convolution(32, 3, stride)];
    case.config.encoder_hidden = vec![128];
    case.config.activation = Activation::Relu;
    case
}

fn normal(len: usize) -> Vec<f32> {
    (0..len as u32)
        .map(|i| gaussian(random4(1, i, 0, 0)))
        .collect()
}

fn network(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("network");
    for case in [
        dense("plane", 17, &[32, 32], 12, 512),
        maps("obstacles", 2),
        maps("obstacles, the paper's", 1),
        dense("105-256-128-28", 105, &[256, 128], 28, 2048),
        dense("210-256-128-28", 210, &[256, 128], 28, 2048),
        dense("223-1024-512-28", 223, &[1024, 512], 28, 2048),
    ] {
        let Case {
            name, action, rows, ..
        } = case;
        let networks = ActorCritic::new(&case.config, &case.observation, action).expect("networks");
        let flops = (networks.actor.flops() + networks.critic.flops()) as u64 * rows as u64;
        let (parameters, extras) = (networks.parameters(), action + SUMS);
        let device = &Device::Cpu;
        let all = networks.networks();
        let mut engine =
            Engine::new(device, all, parameters, extras, rows, rows).expect("an engine");
        let width = case.observation.dim() + 2 * action + 4;
        let samples = Array::from(normal(rows * width));
        let observations = Array::from(normal(rows * case.observation.dim()));
        let order: Vec<u32> = (0..rows as u32).map(|i| i * 7 % rows as u32).collect();
        let mut flat = Array::from(networks.init(1, -0.5, &[]));
        let mut adam = Adam::new(device, parameters);
        let old_log_std = Array::from(vec![-0.5; action]);
        let objective = PpoLoss {
            action,
            log_std: networks.log_std(),
            old_log_std: &old_log_std,
            coefficients: LossCoefficients {
                clip: 0.2,
                value_clip: 0.0,
                value_coefficient: 1.0,
                entropy_coefficient: 0.0,
                kl_coefficient: 0.0,
                inv_count: 1.0 / rows as f32,
            },
        };
        let mut outputs = Array::from(vec![0.0; rows * action]);
        let mut gradient = Array::from(vec![0.0; parameters]);
        let mut sums = Array::from(vec![0.0; SUMS]);
        for threads in [1, 2] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            let pool = pool.build().expect("threads start");
            group.throughput(Throughput::Elements(flops));
            group.bench_function(format!("{name}, forward, threads: {threads}"), |b| {
                b.iter(|| {
                    pool.install(|| {
                        for network in [0, 1] {
                            let out = &mut outputs;
                            engine.forward(network, &flat, &observations, 0, rows, out, 0);
                        }
                    });
                });
            });
            group.throughput(Throughput::Elements(3 * flops));
            group.bench_function(format!("{name}, learning, threads: {threads}"), |b| {
                b.iter(|| {
                    pool.install(|| {
                        engine.gradient(
                            &flat,
                            &samples,
                            width,
                            Rows::Indices(&order),
                            &objective,
                            &mut gradient,
                            &mut sums,
                        );
                        adam.step(&mut flat, &gradient, 1e-6, 0.5);
                    });
                });
            });
        }
    }
    group.finish();
}

criterion_group!(benches, network);
criterion_main!(benches);
