//! The environments alone: random actions of deviation 1, no networks.

use super::clock::{TOO_LONG_S, Work, seconds};
use super::{Bench, ENVS, Item, Record};
use crate::gpu::{Buffer, Device};
use crate::kernels::locomotion::locomotion_layout::{VELOCITY_DIM, MAP_WORDS, boxes, state_f32, state_u32};
use crate::kernels::locomotion::{hits, rasterize_maps};
use crate::motion::features::TRAJECTORY_DIM;
use crate::env::locomotion::{self, LEVELS, Obstacles, Plane, Setup, EnvState, Task};
use anyhow::Result;
use burn::tensor::Tensor;

pub fn measure(bench: &Bench, record: &mut Record) -> Result<()> {
    for task in [
        Task::Plane(Plane::default()),
        Task::Obstacles(Obstacles::FAST),
    ] {
        let mut last = 0.0;
        for envs in ENVS {
            let held = bench
                .place
                .device
                .holds("observations", envs * task.width())
                .is_ok();
            if 4.0 * last > TOO_LONG_S || !held {
                break;
            }
            let batch = Batch { bench, task, envs };
            if bench.plan.wants("environment") {
                last = batch.step(record)?;
            }
            if task.obstacles() > 0 {
                batch.kernels(record)?;
            }
        }
    }
    Ok(())
}

struct Batch<'a> {
    bench: &'a Bench<'a>,
    task: Task,
    envs: usize,
}

impl Batch<'_> {
    fn setup(&self) -> Setup {
        Setup {
            task: self.task,
            envs: self.envs,
            horizon: 1,
            seed: 1,
            level: LEVELS - 1,
        }
    }

    /// Bytes of the worlds' state and of what they show.
    fn bytes(&self) -> usize {
        let obstacles = self.task.obstacles() * (boxes::FIELDS + VELOCITY_DIM) + MAP_WORDS;
        let numbers = state_f32::FIELDS + state_u32::FIELDS + 2 * self.task.width();
        4 * self.envs
            * (numbers
                + if self.task.obstacles() > 0 {
                    obstacles
                } else {
                    0
                })
    }

    fn item(&self, stage: &'static str, bytes: Option<usize>, work: Work) -> Item<'static> {
        Item {
            stage,
            variant: self.task.name(),
            frames: self.bench.database.candidates.len(),
            envs: self.envs,
            batch: self.envs,
            bytes,
            work,
        }
    }

    /// Seconds of a whole step, search and observation included.
    fn step(&self, record: &mut Record) -> Result<f64> {
        let Bench { place, ceiling, .. } = *self.bench;
        (record.tell)(&format!(
            "{}: {} of {}",
            place.name(),
            self.task.name(),
            self.envs
        ));
        let time = place.inside(|| -> Result<f64> {
            let mut world = locomotion::open(&place.device, self.bench.database, &self.setup());
            let tensors = place.device.tensors();
            let mean = Tensor::<2>::zeros([self.envs, TRAJECTORY_DIM], &tensors);
            let log_std = Tensor::<1>::zeros([TRAJECTORY_DIM], &tensors);
            seconds(place, || {
                let (action, _) = world.act(mean.clone(), log_std.clone());
                world.step(action);
                world.observe();
                Ok(())
            })
        })?;
        let item = self.item("environment", Some(self.bytes()), Work::default());
        record.add(place, ceiling, item, time);
        Ok(time)
    }

    /// Maps and hits alone.
    fn kernels(&self, record: &mut Record) -> Result<()> {
        let Bench {
            plan,
            place,
            ceiling,
            ..
        } = *self.bench;
        let count = self.task.obstacles();
        let read = 4.0 * ((boxes::FIELDS + VELOCITY_DIM) * count) as f64;
        let maps = 4.0 * MAP_WORDS as f64;
        let asked = 4.0 * TRAJECTORY_DIM as f64;
        for (stage, bytes) in [("rasterise", read + maps), ("hits", read + asked)] {
            if !plan.wants(stage) {
                continue;
            }
            let snapshot =
                locomotion::open(&place.device, self.bench.database, &self.setup()).snapshot()?;
            let normal = self.bench.database.normalisation.trajectory();
            let kernels = Kernels {
                batch: self,
                snapshot,
                action: vec![0.5; self.envs * TRAJECTORY_DIM],
                normal,
            };
            let time = match (&place.device, stage) {
                (Device::Cpu, _) => place.inside(|| kernels.on_cpu(stage)),
                (Device::Gpu(_), _) => kernels.on_gpu(stage),
            }?;
            let work = Work {
                bytes,
                operations: 0.0,
            };
            record.add(place, ceiling, self.item(stage, None, work), time);
        }
        Ok(())
    }
}

struct Kernels<'a> {
    batch: &'a Batch<'a>,
    snapshot: EnvState,
    action: Vec<f32>,
    normal: Vec<f32>,
}

impl Kernels<'_> {
    fn sense(&self) -> rasterize_maps::Params {
        // All worlds of the snapshot stand at the start of an episode.
        self.batch
            .setup()
            .rules(self.batch.bench.database)
            .sense(true)
    }

    fn hits(&self) -> hits::Params {
        hits::Params {
            envs: self.batch.envs as u32,
            count: self.batch.task.obstacles() as u32,
        }
    }

    fn on_cpu(mut self, stage: &str) -> Result<f64> {
        let (sense, hits) = (self.sense(), self.hits());
        let state = &mut self.snapshot;
        seconds(self.batch.bench.place, || {
            match stage {
                "hits" => hits::twin(
                    &self.action,
                    &self.normal,
                    &state.boxes,
                    &state.state_f32,
                    &mut state.state_u32,
                    &hits,
                ),
                _ => rasterize_maps::twin(
                    &state.boxes,
                    &state.obstacle_velocity,
                    &state.state_f32,
                    &state.state_u32,
                    &mut state.maps,
                    &sense,
                ),
            }
            Ok(())
        })
    }

    fn on_gpu(&self, stage: &str) -> Result<f64> {
        let place = self.batch.bench.place;
        let Device::Gpu(gpu) = &place.device else {
            anyhow::bail!("not a GPU");
        };
        let state = &self.snapshot;
        let boxes = Buffer::from_slice(gpu, &state.boxes);
        let obstacle_velocity = Buffer::from_slice(gpu, &state.obstacle_velocity);
        let state_f32 = Buffer::from_slice(gpu, &state.state_f32);
        let state_u32 = Buffer::from_slice(gpu, &state.state_u32);
        let maps = Buffer::from_slice(gpu, &state.maps);
        let action = Buffer::from_slice(gpu, &self.action);
        let normal = Buffer::from_slice(gpu, &self.normal);
        seconds(place, || {
            match stage {
                "hits" => {
                    hits::launch(gpu, &action, &normal, &boxes, &state_f32, &state_u32, &self.hits());
                }
                _ => rasterize_maps::launch(gpu, &boxes, &obstacle_velocity, &state_f32, &state_u32, &maps, &self.sense()),
            }
            Ok(())
        })
    }
}
