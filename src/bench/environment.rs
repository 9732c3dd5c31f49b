//! The motion-matching environments alone: random actions of standard deviation 1, no networks.

use super::clock::{MAX_CALL_S, seconds};
use super::recorder::{Recorder, Workload};
use super::roofline::ItemCost;
use super::stage::{BenchContext, ENVS};
use crate::env::locomotion::{CpuLocomotion, EnvConfig, LEVELS, LocomotionTask, Obstacles, Plane};
use crate::env::{Transition, VecEnv};
use crate::gpu::{Array, Buffer, Device, Gpu};
use crate::kernels::locomotion::locomotion_layout::{
    MAP_WORDS, VELOCITY_DIM, boxes, state_f32, state_u32,
};
use crate::kernels::locomotion::{hits, rasterize_maps};
use crate::kernels::rng::{gaussian, random4};
use crate::motion::features::TRAJECTORY_DIM;
use anyhow::Result;
use rayon::prelude::*;

/// Steps that have actions of their own.
const ACTIONS: usize = 16;

/// Measures both tasks in rising numbers of environments, on the hardest level.
pub fn measure(bench: &BenchContext, record: &mut Recorder) -> Result<()> {
    let tasks = [
        LocomotionTask::Plane(Plane::default()),
        LocomotionTask::Obstacles(Obstacles {
            curriculum: false,
            ..Obstacles::FAST
        }),
    ];
    for task in tasks {
        let mut last = 0.0;
        for envs in ENVS {
            let config = EnvConfig {
                task,
                envs,
                seed: 1,
                level: LEVELS - 1,
            };
            let numbers = envs * config.spec().observation.dim();
            let fits = bench.on.device.holds("observations", numbers).is_ok();
            if 4.0 * last > MAX_CALL_S || !fits {
                break;
            }
            let stage = Stage { bench, config };
            if bench.plan.selects("environment") {
                last = stage.step(record)?;
            }
            if task.obstacles() > 0 {
                stage.kernels(record)?;
            }
        }
    }
    Ok(())
}

struct Stage<'a> {
    bench: &'a BenchContext<'a>,
    config: EnvConfig,
}

impl Stage<'_> {
    /// Bytes of the environments' state and of their observations.
    fn bytes(&self) -> usize {
        let count = self.config.task.obstacles();
        let obstacles = match count {
            0 => 0,
            _ => count * (boxes::FIELDS + VELOCITY_DIM) + MAP_WORDS,
        };
        let observation = self.config.spec().observation.dim();
        let numbers = state_f32::FIELDS + state_u32::FIELDS + 2 * observation + obstacles;
        4 * self.config.envs * numbers
    }

    fn workload(&self, stage: &'static str, bytes: Option<usize>, cost: ItemCost) -> Workload<'_> {
        Workload {
            stage,
            variant: self.config.task.name(),
            frames: self.bench.matcher.database.candidates.len(),
            envs: self.config.envs,
            batch: self.config.envs,
            bytes,
            cost,
        }
    }

    /// Seconds of a whole step, search and observation included.
    fn step(&self, record: &mut Recorder) -> Result<f64> {
        let BenchContext { on, roofline, .. } = *self.bench;
        let (task, envs) = (self.config.task.name(), self.config.envs);
        (record.tell)(&format!("{}: {task} of {envs}", on.name()));
        let time = on.install(|| -> Result<f64> {
            let batch = self.config.open(&on.device, self.bench.matcher)?;
            let parts = batch.parts.into_iter().enumerate();
            let mut parts: Vec<Part> = parts
                .map(|(number, envs)| Part::new(envs, number as u32, &on.device))
                .collect();
            seconds(on, || {
                parts.par_iter_mut().for_each(Part::step);
                Ok(())
            })
        })?;
        let workload = self.workload("environment", Some(self.bytes()), ItemCost::default());
        record.add(on, roofline, workload, time);
        Ok(time)
    }

    /// Measures the kernels of maps and hits alone.
    fn kernels(&self, record: &mut Recorder) -> Result<()> {
        let BenchContext {
            plan, on, roofline, ..
        } = *self.bench;
        let obstacles =
            4.0 * ((boxes::FIELDS + VELOCITY_DIM) * self.config.task.obstacles()) as f64;
        let maps = 4.0 * MAP_WORDS as f64;
        let requested = 4.0 * TRAJECTORY_DIM as f64;
        for (stage, bytes) in [
            ("rasterize_maps", obstacles + maps),
            ("hits", obstacles + requested),
        ] {
            if !plan.selects(stage) {
                continue;
            }
            let kernels = Kernels {
                bench: self.bench,
                env: CpuLocomotion::new(self.bench.matcher.clone(), &self.config),
                action: vec![0.5; self.config.envs * TRAJECTORY_DIM],
                normal: self.bench.matcher.database.normalisation.trajectory(),
            };
            let time = match &on.device {
                Device::Cpu => on.install(|| kernels.on_cpu(stage)),
                Device::Gpu(gpu) => kernels.on_gpu(gpu, stage),
            }?;
            let cost = ItemCost {
                bytes,
                operations: 0.0,
            };
            record.add(on, roofline, self.workload(stage, None, cost), time);
        }
        Ok(())
    }
}

/// A part of a batch, with random actions and the columns that a step writes.
struct Part {
    env: Box<dyn VecEnv>,
    /// `[ACTIONS][rows][action]`
    actions: Array,
    step: usize,
    observation: Array,
    reward: Array,
    style_reward: Array,
    termination: Array<u32>,
    group: Array<u32>,
    final_observation: Array,
}

impl Part {
    fn new(env: Box<dyn VecEnv>, number: u32, device: &Device) -> Self {
        let spec = *env.spec();
        let (rows, observation) = (spec.rows(), spec.rows() * spec.observation.dim());
        let noise = |i| gaussian(random4(1, i as u32, number, 0));
        let actions: Vec<f32> = (0..ACTIONS * rows * spec.action).map(noise).collect();
        Part {
            env,
            actions: Array::from_slice(device, &actions),
            step: 0,
            observation: Array::zeroed(device, observation),
            reward: Array::zeroed(device, rows),
            style_reward: Array::zeroed(device, rows),
            termination: Array::zeroed(device, rows),
            group: Array::zeroed(device, rows),
            final_observation: Array::zeroed(device, spec.final_steps(1) * observation),
        }
    }

    fn step(&mut self) {
        let of_step = self.actions.len() / ACTIONS;
        let out = Transition {
            step: 0,
            reward: &mut self.reward,
            style_reward: &mut self.style_reward,
            termination: &mut self.termination,
            group: &mut self.group,
            final_observation: &mut self.final_observation,
        };
        self.env.step(&self.actions, self.step * of_step, out);
        self.env.observe(&mut self.observation, 0);
        self.step = (self.step + 1) % ACTIONS;
    }
}

struct Kernels<'a> {
    bench: &'a BenchContext<'a>,
    /// All environments at the start of an episode.
    env: CpuLocomotion,
    action: Vec<f32>,
    normal: Vec<f32>,
}

impl Kernels<'_> {
    fn on_cpu(mut self, stage: &str) -> Result<f64> {
        let env = &mut self.env;
        let (maps, hits) = (env.params.rasterize_maps(true), env.params.hits(0));
        seconds(self.bench.on, || {
            match stage {
                "hits" => hits::twin(
                    &self.action,
                    &self.normal,
                    &env.boxes,
                    &env.state_f32,
                    &mut env.state_u32,
                    &hits,
                ),
                _ => rasterize_maps::twin(
                    &env.boxes,
                    &env.obstacle_velocity,
                    &env.state_f32,
                    &env.state_u32,
                    &mut env.maps,
                    &maps,
                ),
            }
            Ok(())
        })
    }

    fn on_gpu(&self, gpu: &Gpu, stage: &str) -> Result<f64> {
        let env = &self.env;
        let (rasterize, count_hits) = (env.params.rasterize_maps(true), env.params.hits(0));
        let boxes = Buffer::from_slice(gpu, &env.boxes);
        let velocity = Buffer::from_slice(gpu, &env.obstacle_velocity);
        let state_f32 = Buffer::from_slice(gpu, &env.state_f32);
        let state_u32 = Buffer::from_slice(gpu, &env.state_u32);
        let maps = Buffer::from_slice(gpu, &env.maps);
        let action = Buffer::from_slice(gpu, &self.action);
        let normal = Buffer::from_slice(gpu, &self.normal);
        seconds(self.bench.on, || {
            match stage {
                "hits" => hits::launch(
                    gpu,
                    &action,
                    &normal,
                    &boxes,
                    &state_f32,
                    &state_u32,
                    &count_hits,
                ),
                _ => rasterize_maps::launch(
                    gpu, &boxes, &velocity, &state_f32, &state_u32, &maps, &rasterize,
                ),
            }
            Ok(())
        })
    }
}
