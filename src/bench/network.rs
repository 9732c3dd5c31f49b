//! Networks alone: the outputs of actor and critic, and a gradient step of PPO on a minibatch.

use super::clock::seconds;
use super::recorder::{Recorder, Workload};
use super::roofline::ItemCost;
use super::stage::BenchContext;
use crate::gpu::{Array, Device};
use crate::kernels::rng::{gaussian, random4};
use crate::nn::layer::Activation;
use crate::nn::observation::ObservationSpec;
use crate::nn::{ActorCritic, Adam, Engine, NetworkConfig, Rows};
use crate::rl::ppo::loss::{Diversity, LossCoefficients, PpoLoss, SUMS};
use crate::train::config::Preset;
use crate::train::tasks::REGISTRY;
use anyhow::Result;

/// Networks wider than those of the tasks: inputs and hidden layers.
const WIDE: [(&str, usize, [usize; 2]); 3] = [
    ("105-256-128-28", 105, [256, 128]),
    ("210-256-128-28", 210, [256, 128]),
    ("223-1024-512-28", 223, [1024, 512]),
];
const WIDE_ACTION: usize = 28;
const WIDE_ROWS: usize = 2048;

/// Networks to measure, and the rows of a minibatch.
struct Case {
    name: String,
    networks: ActorCritic,
    rows: usize,
}

/// Networks of the tasks' presets, and the wide ones.
fn cases() -> Result<Vec<Case>> {
    let mut cases = Vec::new();
    for task in &REGISTRY {
        let mut seen: Vec<ActorCritic> = Vec::new();
        for (preset, suffix) in [(Preset::Fast, ""), (Preset::Paper, ", paper")] {
            let config = task.config(preset);
            let spec = task.check(&config)?;
            let networks =
                ActorCritic::new(&config.ppo.network, &spec.observation, spec.action, 1)?;
            if !seen.contains(&networks) {
                cases.push(Case {
                    name: format!("{}{suffix}", task.name),
                    networks: networks.clone(),
                    rows: config.ppo.minibatch_size,
                });
                seen.push(networks);
            }
        }
    }
    for (name, vector, hidden) in WIDE {
        let config = NetworkConfig {
            convolutions: Vec::new(),
            encoder_hidden: Vec::new(),
            hidden: hidden.to_vec(),
            activation: Activation::Tanh,
        };
        let observation = ObservationSpec { vector, grid: None };
        cases.push(Case {
            name: name.to_string(),
            networks: ActorCritic::new(&config, &observation, WIDE_ACTION, 1)?,
            rows: WIDE_ROWS,
        });
    }
    Ok(cases)
}

/// Measures all networks.
pub fn measure(context: &BenchContext, record: &mut Recorder) -> Result<()> {
    let BenchContext {
        plan, on, roofline, ..
    } = *context;
    for case in cases()? {
        let Case { name, networks, .. } = &case;
        let flops = (networks.actor.flops() + networks.critic.flops()) as f64;
        // The gradient takes twice the operations of the outputs besides these.
        for (stage, times) in [("network", 1.0), ("gradient", 3.0)] {
            if !plan.selects(stage) {
                continue;
            }
            (record.tell)(&format!("{}: {stage}, {name}", on.name()));
            let time = on.install(|| -> Result<f64> {
                let mut pass = Pass::new(&case, &on.device)?;
                seconds(on, || {
                    match stage {
                        "network" => pass.forward(),
                        _ => pass.gradient(),
                    }
                    Ok(())
                })
            })?;
            let workload = Workload {
                stage,
                variant: name,
                frames: 0,
                envs: 0,
                batch: case.rows,
                bytes: Some(4 * networks.parameters()),
                cost: ItemCost {
                    bytes: 0.0,
                    operations: times * flops,
                },
            };
            record.add(on, roofline, workload, time);
        }
    }
    Ok(())
}

/// Networks with a minibatch of noise.
struct Pass<'a> {
    case: &'a Case,
    engine: Engine,
    adam: Adam,
    flat: Array,
    gradient: Array,
    sums: Array,
    old_log_std: Array,
    observations: Array,
    outputs: Array,
    /// `[rows][width]`: observation, action, old mean, then four numbers.
    samples: Array,
    width: usize,
    /// The order of the rows, on the CPU.
    order: Option<Vec<u32>>,
}

impl<'a> Pass<'a> {
    fn new(case: &'a Case, device: &Device) -> Result<Self> {
        let Case { networks, rows, .. } = case;
        let (rows, parameters) = (*rows, networks.parameters());
        let (action, dim) = (networks.actor.outputs(), networks.actor.observation().dim());
        let width = dim + 2 * action + 4;
        let normal = |len: usize| {
            let noise: Vec<f32> = (0..len as u32)
                .map(|i| gaussian(random4(1, i, 0, 0)))
                .collect();
            Array::from_slice(device, &noise)
        };
        let all = networks.networks();
        let extras = action + SUMS;
        Ok(Pass {
            case,
            engine: Engine::new(device, all, parameters, extras, rows, rows)?,
            adam: Adam::new(device, parameters),
            flat: Array::from_slice(device, &networks.init(1, -0.5, &[])),
            gradient: Array::zeroed(device, parameters),
            sums: Array::zeroed(device, SUMS),
            old_log_std: Array::from_slice(device, &vec![-0.5; action]),
            observations: normal(rows * dim),
            outputs: Array::zeroed(device, rows * action),
            samples: normal(rows * width),
            width,
            order: match device {
                Device::Cpu => Some((0..rows as u32).map(|i| i * 7 % rows as u32).collect()),
                Device::Gpu(_) => None,
            },
        })
    }

    fn forward(&mut self) {
        let (rows, out) = (self.case.rows, &mut self.outputs);
        for network in [0, 1] {
            let (flat, observations) = (&self.flat, &self.observations);
            self.engine
                .forward(network, flat, observations, 0, rows, out, 0);
        }
    }

    fn gradient(&mut self) {
        let Case { networks, rows, .. } = self.case;
        let objective = PpoLoss {
            action: networks.actor.outputs(),
            values: networks.critic.outputs(),
            log_std: networks.log_std(),
            old_log_std: &self.old_log_std,
            diversity: Diversity::default(),
            coefficients: LossCoefficients {
                clip: 0.2,
                value_clip: 0.0,
                value_coefficient: 1.0,
                entropy_coefficient: 0.0,
                kl_coefficient: 0.0,
                std_coefficient: 1.0,
                inv_count: 1.0 / *rows as f32,
            },
        };
        let minibatch = match &self.order {
            Some(order) => Rows::Indices(order),
            None => Rows::Range(0..*rows),
        };
        self.engine.gradient(
            &self.flat,
            &self.samples,
            self.width,
            minibatch,
            &objective,
            &mut self.gradient,
            &mut self.sums,
        );
        self.adam.step(&mut self.flat, &self.gradient, 1e-6, 0.5);
    }
}
