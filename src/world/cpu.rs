//! A batch of worlds on the CPU: the twins, with the pruned search in place of the plain one.

use super::{Plane, Snapshot, Values, World};
use crate::kernels::layout::{OBSERVATION, end, real, whole};
use crate::kernels::{act, gae, observe, query, reset, step, tally};
use crate::motion::database::{Database, PADDED};
use crate::motion::features::TRAJECTORY;
use crate::search::Index;
use crate::tensors::upload;
use burn::tensor::{Device, Tensor};
use std::sync::Arc;

pub struct CpuWorld {
    database: Arc<Database>,
    index: Index,
    task: Plane,
    envs: usize,
    horizon: usize,
    seed: u32,
    clock: u32,
    /// `[real::FIELDS][envs]`, see [`crate::kernels::layout`].
    pub real: Vec<f32>,
    /// `[whole::FIELDS][envs]`
    pub whole: Vec<u32>,
    queries: Vec<[f32; PADDED]>,
    matched: Vec<u32>,
    /// `[horizon][envs]`
    reward: Vec<f32>,
    /// `[horizon][envs]`, how each step ended.
    pub ended: Vec<u32>,
    /// `[envs][OBSERVATION]`
    truncated: Vec<f32>,
    device: Device,
}

impl CpuWorld {
    pub fn new(
        database: Arc<Database>,
        task: Plane,
        envs: usize,
        horizon: usize,
        seed: u32,
    ) -> Self {
        let mut world = CpuWorld {
            index: Index::build(&database.rows()),
            task,
            envs,
            horizon,
            seed,
            clock: 0,
            real: vec![0.0; real::FIELDS * envs],
            whole: vec![0; whole::FIELDS * envs],
            queries: vec![[0.0; PADDED]; envs],
            matched: vec![0; envs],
            reward: vec![0.0; horizon * envs],
            ended: vec![0; horizon * envs],
            truncated: vec![0.0; envs * OBSERVATION],
            device: Device::flex(),
            database,
        };
        world.reset(true, task.max_steps);
        world
    }

    /// Worlds that all start their first episode at age 0, for episodes that are counted.
    pub fn fresh(database: Arc<Database>, task: Plane, envs: usize, seed: u32) -> Self {
        let mut world = Self::new(database, task, envs, 1, seed);
        world.reset(true, 0);
        world
    }

    /// Where this step's rewards and ends go in the rollout.
    fn offset(&self) -> usize {
        self.clock as usize % self.horizon * self.envs
    }

    /// Starts new episodes, `everywhere` or where this step ended one, at ages below `spread`.
    fn reset(&mut self, everywhere: bool, spread: u32) {
        let params = reset::Params {
            envs: self.envs as u32,
            candidates: self.database.candidates.len() as u32,
            seed: self.seed,
            clock: self.clock,
            offset: self.offset() as u32,
            everywhere: everywhere.into(),
            spread,
            half_side: self.task.half_side,
            reach: self.task.reach,
        };
        reset::twin(
            &self.database.candidates,
            &self.ended,
            &mut self.real,
            &mut self.whole,
            &params,
        );
    }

    fn see(&self, observation: &mut [f32], only: u32) {
        let params = observe::Params {
            envs: self.envs as u32,
            offset: self.offset() as u32,
            only,
        };
        observe::twin(
            &self.database.features,
            &self.real,
            &self.whole,
            &self.ended,
            observation,
            &params,
        );
    }

    /// Plays one step without starting anew what it ended. `action` is `[envs][TRAJECTORY]`.
    pub fn play(&mut self, action: &[f32]) {
        let envs = self.envs as u32;
        query::twin(
            &self.database.features,
            &self.whole,
            action,
            &mut self.queries,
            &query::Params { envs },
        );
        self.index.nearest_all(&self.queries, &mut self.matched);
        let params = step::Params {
            envs,
            offset: self.offset() as u32,
            max_steps: self.task.max_steps,
            reach: self.task.reach,
            bonus: self.task.bonus,
        };
        step::twin(
            &self.database.candidates,
            &self.matched,
            &self.database.motion,
            &mut self.real,
            &mut self.whole,
            &mut self.reward,
            &mut self.ended,
            &params,
        );
    }

    fn tensor<const D: usize>(&self, values: Vec<f32>, shape: [usize; D]) -> Tensor<D> {
        upload(values, shape, &self.device)
    }
}

/// Values of a CPU tensor: there is no device to lose and f32 is the only type in use.
fn values<const D: usize>(tensor: Tensor<D>) -> Vec<f32> {
    match crate::tensors::read(tensor) {
        Ok(values) => values,
        Err(error) => unreachable!("{error}"),
    }
}

impl World for CpuWorld {
    fn envs(&self) -> usize {
        self.envs
    }

    fn observe(&mut self) -> Tensor<2> {
        let mut observation = vec![0.0; self.envs * OBSERVATION];
        self.see(&mut observation, end::RUNNING);
        self.tensor(observation, [self.envs, OBSERVATION])
    }

    fn act(&mut self, mean: Tensor<2>, log_std: Tensor<1>) -> (Tensor<2>, Tensor<1>) {
        let (mut action, mut log_prob) = (vec![0.0; self.envs * TRAJECTORY], vec![0.0; self.envs]);
        let params = act::Params {
            envs: self.envs as u32,
            seed: self.seed,
            clock: self.clock,
        };
        act::twin(
            &values(mean),
            &values(log_std),
            &mut action,
            &mut log_prob,
            &params,
        );
        (
            self.tensor(action, [self.envs, TRAJECTORY]),
            self.tensor(log_prob, [self.envs]),
        )
    }

    fn step(&mut self, action: Tensor<2>) {
        self.play(&values(action));
        let mut truncated = std::mem::take(&mut self.truncated);
        self.see(&mut truncated, end::TRUNCATED);
        self.truncated = truncated;
        self.reset(false, 0);
        self.clock += 1;
    }

    fn truncated(&mut self) -> Tensor<2> {
        self.tensor(self.truncated.clone(), [self.envs, OBSERVATION])
    }

    fn judge(&mut self, judged: Values, gamma: f32, lambda: f32) -> (Tensor<1>, Tensor<1>) {
        let samples = self.horizon * self.envs;
        let (mut advantage, mut target) = (vec![0.0; samples], vec![0.0; samples]);
        let scale = values(judged.scale);
        gae::twin(
            &self.reward,
            &self.ended,
            &values(judged.observed),
            &values(judged.next),
            &values(judged.last),
            &scale,
            &mut advantage,
            &mut target,
            &gae::Params {
                envs: self.envs as u32,
                steps: self.horizon as u32,
                gamma,
                lambda,
            },
        );
        (
            self.tensor(advantage, [samples]),
            self.tensor(target, [samples]),
        )
    }

    fn tally(&mut self) -> Tensor<1> {
        let mut sums = [0.0; 4];
        tally::twin(
            &mut self.real,
            &mut self.whole,
            &mut sums,
            &tally::Params {
                envs: self.envs as u32,
            },
        );
        self.tensor(sums.to_vec(), [4])
    }

    fn snapshot(&self) -> anyhow::Result<Snapshot> {
        Ok(Snapshot {
            clock: self.clock,
            real: self.real.clone(),
            whole: self.whole.clone(),
        })
    }

    fn restore(&mut self, snapshot: &Snapshot) {
        self.clock = snapshot.clock;
        self.real.clone_from(&snapshot.real);
        self.whole.clone_from(&snapshot.whole);
    }
}
