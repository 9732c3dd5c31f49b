//! The networks of both tasks' preset `fast`, and wide ones: the actor's outputs for many observations at
//! once, and gradient steps over a whole rollout.

use super::clock::seconds;
use super::recorder::{Recorder, Workload};
use super::roofline::ItemCost;
use super::stage::BenchContext;
use super::training::{self, Case};
use crate::gpu::Array;
use crate::kernels::learn::gather_samples::width;
use crate::kernels::rng::{gaussian, random4};
use crate::nn::layer::Activation;
use crate::nn::observation::ObservationSpec;
use crate::nn::{ActorCritic, Adam, Engine, NetworkConfig, Rows};
use crate::rl::ppo::loss::{LossCoefficients, PpoLoss, SUMS};
use anyhow::Result;

/// Observation and hidden layers of policies of simulated bodies, whose actions have 28 numbers.
const WIDE: [(&str, usize, [usize; 2]); 3] = [
    ("105-256-128-28", 105, [256, 128]),
    ("210-256-128-28", 210, [256, 128]),
    ("223-1024-512-28", 223, [1024, 512]),
];
const WIDE_ACTION: usize = 28;
const WIDE_ROWS: usize = 2048;

pub fn measure(bench: &BenchContext, record: &mut Recorder) -> Result<()> {
    for (stage, measure) in [("network", forward as Stage), ("update", update)] {
        if !bench.plan.selects(stage) {
            continue;
        }
        training::each(bench, |case| {
            let networks = Networks::of(case)?;
            measure(bench, &networks, record)
        })?;
        for (name, vector, hidden) in WIDE {
            measure(bench, &Networks::wide(name, vector, &hidden)?, record)?;
        }
    }
    Ok(())
}

/// Measures a stage of such networks and returns the seconds it takes once.
type Stage = fn(&BenchContext, &Networks, &mut Recorder) -> Result<f64>;

/// What is evaluated, and learned from how much.
struct Networks {
    name: &'static str,
    layout: ActorCritic,
    /// Environments; 0 where there are none.
    envs: usize,
    /// Observations evaluated at once.
    rows: usize,
    samples: usize,
    minibatch: usize,
    epochs: usize,
    coefficients: LossCoefficients,
}

impl Networks {
    fn of(case: &Case) -> Result<Self> {
        let (ppo, spec) = (&case.ppo, case.spec());
        Ok(Networks {
            name: case.name(),
            layout: ActorCritic::new(&ppo.network, &spec.observation, spec.action)?,
            envs: case.env.envs,
            rows: case.env.envs,
            samples: ppo.batch(),
            minibatch: ppo.minibatch_size,
            epochs: ppo.epochs,
            coefficients: LossCoefficients::new(ppo, ppo.kl_coefficient),
        })
    }

    fn wide(name: &'static str, vector: usize, hidden: &[usize]) -> Result<Self> {
        let config = NetworkConfig {
            convolutions: Vec::new(),
            encoder_hidden: Vec::new(),
            hidden: hidden.to_vec(),
            activation: Activation::Tanh,
        };
        let observation = ObservationSpec { vector, grid: None };
        Ok(Networks {
            name,
            layout: ActorCritic::new(&config, &observation, WIDE_ACTION)?,
            envs: 0,
            rows: WIDE_ROWS,
            samples: WIDE_ROWS,
            minibatch: WIDE_ROWS,
            epochs: 1,
            coefficients: LossCoefficients {
                clip: 0.2,
                value_clip: 0.0,
                value_coefficient: 1.0,
                entropy_coefficient: 0.0,
                kl_coefficient: 0.0,
                inv_count: 1.0,
            },
        })
    }

    fn engine(&self, bench: &BenchContext) -> Result<Engine> {
        let extras = self.layout.actor.outputs() + SUMS;
        Engine::new(
            &bench.on.device,
            self.layout.networks(),
            self.layout.parameters(),
            extras,
            self.rows,
            self.minibatch,
        )
    }

    fn parameters(&self, bench: &BenchContext) -> Array {
        Array::from_slice(&bench.on.device, &self.layout.init(1, -0.5, &[]))
    }

    fn observation(&self) -> usize {
        self.layout.actor.observation().dim()
    }
}

fn noise(bench: &BenchContext, len: usize) -> Array {
    let noise: Vec<f32> = (0..len as u32)
        .map(|i| gaussian(random4(1, i, 0, 0)))
        .collect();
    Array::from_slice(&bench.on.device, &noise)
}

fn forward(bench: &BenchContext, networks: &Networks, record: &mut Recorder) -> Result<f64> {
    let BenchContext { on, roofline, .. } = *bench;
    let rows = networks.rows;
    (record.tell)(&format!(
        "{}: network, {} of {rows}",
        on.name(),
        networks.name
    ));
    let actor = &networks.layout.actor;
    let time = on.install(|| -> Result<f64> {
        let (engine, parameters) = (networks.engine(bench)?, networks.parameters(bench));
        let observations = noise(bench, rows * networks.observation());
        let mut means = Array::zeroed(&on.device, rows * actor.outputs());
        seconds(on, || {
            engine.forward(0, &parameters, &observations, 0, rows, &mut means, 0);
            Ok(())
        })
    })?;
    let workload = Workload {
        stage: "network",
        variant: networks.name,
        frames: 0,
        envs: networks.envs,
        batch: rows,
        bytes: Some(4 * networks.layout.parameters()),
        cost: ItemCost {
            bytes: 0.0,
            operations: actor.flops() as f64,
        },
    };
    record.add(on, roofline, workload, time);
    Ok(time)
}

/// All epochs over samples of noise.
fn update(bench: &BenchContext, networks: &Networks, record: &mut Recorder) -> Result<f64> {
    let BenchContext { on, roofline, .. } = *bench;
    let Networks {
        samples, minibatch, ..
    } = *networks;
    (record.tell)(&format!(
        "{}: update, {} of {samples}",
        on.name(),
        networks.name
    ));
    let layout = &networks.layout;
    let action = layout.actor.outputs();
    let width = width(networks.observation(), action);
    let time = on.install(|| -> Result<f64> {
        let (mut engine, mut parameters) = (networks.engine(bench)?, networks.parameters(bench));
        let mut adam = Adam::new(&on.device, layout.parameters());
        let mut gradient = Array::zeroed(&on.device, layout.parameters());
        let mut sums = Array::zeroed(&on.device, SUMS);
        let old_log_std = Array::from_slice(&on.device, &vec![-0.5; action]);
        let rows = noise(bench, samples * width);
        seconds(on, || {
            for start in (0..networks.epochs).flat_map(|_| (0..samples).step_by(minibatch)) {
                let end = samples.min(start + minibatch);
                let objective = PpoLoss {
                    action,
                    log_std: layout.log_std(),
                    old_log_std: &old_log_std,
                    coefficients: LossCoefficients {
                        inv_count: 1.0 / (end - start) as f32,
                        ..networks.coefficients
                    },
                };
                let minibatch = Rows::Range(start..end);
                engine.gradient(
                    &parameters,
                    &rows,
                    width,
                    minibatch,
                    &objective,
                    &mut gradient,
                    &mut sums,
                );
                // So slowly that noise leads nowhere.
                adam.step(&mut parameters, &gradient, 1e-9, 1.0);
            }
            Ok(())
        })
    })?;
    let flops = layout.actor.flops() + layout.critic.flops();
    let workload = Workload {
        stage: "update",
        variant: networks.name,
        frames: 0,
        envs: networks.envs,
        batch: samples,
        bytes: Some(4 * 3 * layout.parameters()),
        cost: ItemCost {
            bytes: 0.0,
            // Forward, and twice as much backward, in every epoch.
            operations: (3 * networks.epochs * flops) as f64,
        },
    };
    record.add(on, roofline, workload, time);
    Ok(time)
}
