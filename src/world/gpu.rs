//! A batch of worlds on the GPU: one launch after another on burn's own queue, nothing copied to
//! the host.

use super::{Plane, Snapshot, Values, World};
use crate::gpu::tensor::{from_buffer, to_buffer};
use crate::gpu::{Buffer, Gpu};
use crate::kernels::layout::{OBSERVATION, end, real, whole};
use crate::kernels::{
    act, gae, observe, query, reset, search_exact, search_tile, search_wide, step, tally,
};
use crate::motion::database::{Database, PADDED};
use crate::motion::features::TRAJECTORY;
use burn::tensor::Tensor;

pub struct GpuWorld {
    gpu: Gpu,
    task: Plane,
    envs: usize,
    horizon: usize,
    seed: u32,
    clock: u32,
    candidates: Buffer<u32>,
    /// `[frames][PADDED]`
    features: Buffer<f32>,
    motion: Buffer<f32>,
    /// `[real::FIELDS][envs]`, see [`crate::kernels::layout`].
    real: Buffer<f32>,
    /// `[whole::FIELDS][envs]`
    whole: Buffer<u32>,
    queries: Buffer<f32>,
    search: Search,
    reward: Buffer<f32>,
    ended: Buffer<u32>,
    truncated: Buffer<f32>,
}

impl GpuWorld {
    pub fn new(
        gpu: &Gpu,
        database: &Database,
        task: Plane,
        envs: usize,
        horizon: usize,
        seed: u32,
    ) -> Self {
        let world = GpuWorld {
            task,
            envs,
            horizon,
            seed,
            clock: 0,
            candidates: Buffer::from_slice(gpu, &database.candidates),
            features: Buffer::from_slice(gpu, database.features.as_flattened()),
            motion: Buffer::from_slice(gpu, bytemuck::cast_slice(&database.motion)),
            real: Buffer::zeroed(gpu, real::FIELDS * envs),
            whole: Buffer::zeroed(gpu, whole::FIELDS * envs),
            queries: Buffer::zeroed(gpu, envs * PADDED),
            search: Search::new(gpu, &database.rows(), envs),
            reward: Buffer::zeroed(gpu, horizon * envs),
            ended: Buffer::zeroed(gpu, horizon * envs),
            truncated: Buffer::zeroed(gpu, envs * OBSERVATION),
            gpu: gpu.clone(),
        };
        world.reset(true);
        world
    }

    /// Where this step's rewards and ends go in the rollout.
    fn offset(&self) -> u32 {
        (self.clock as usize % self.horizon * self.envs) as u32
    }

    fn reset(&self, everywhere: bool) {
        let params = reset::Params {
            envs: self.envs as u32,
            candidates: self.candidates.len() as u32,
            seed: self.seed,
            clock: self.clock,
            offset: self.offset(),
            everywhere: everywhere.into(),
            spread: if everywhere { self.task.max_steps } else { 0 },
            half_side: self.task.half_side,
            reach: self.task.reach,
        };
        reset::launch(
            &self.gpu,
            &self.candidates,
            &self.ended,
            &self.real,
            &self.whole,
            &params,
        );
    }

    fn see(&self, observation: &Buffer<f32>, only: u32) {
        let params = observe::Params {
            envs: self.envs as u32,
            offset: self.offset(),
            only,
        };
        observe::launch(
            &self.gpu,
            &self.features,
            &self.real,
            &self.whole,
            &self.ended,
            observation,
            &params,
        );
    }
}

impl World for GpuWorld {
    fn envs(&self) -> usize {
        self.envs
    }

    fn observe(&mut self) -> Tensor<2> {
        let observation = Buffer::empty(&self.gpu, self.envs * OBSERVATION);
        self.see(&observation, end::RUNNING);
        from_buffer(&self.gpu, &observation, [self.envs, OBSERVATION])
    }

    fn act(&mut self, mean: Tensor<2>, log_std: Tensor<1>) -> (Tensor<2>, Tensor<1>) {
        let action = Buffer::empty(&self.gpu, self.envs * TRAJECTORY);
        let log_prob = Buffer::empty(&self.gpu, self.envs);
        let params = act::Params {
            envs: self.envs as u32,
            seed: self.seed,
            clock: self.clock,
        };
        act::launch(
            &self.gpu,
            &to_buffer(mean),
            &to_buffer(log_std),
            &action,
            &log_prob,
            &params,
        );
        (
            from_buffer(&self.gpu, &action, [self.envs, TRAJECTORY]),
            from_buffer(&self.gpu, &log_prob, [self.envs]),
        )
    }

    fn step(&mut self, action: Tensor<2>) {
        let envs = self.envs as u32;
        let action = to_buffer(action);
        query::launch(
            &self.gpu,
            &self.features,
            &self.whole,
            &action,
            &self.queries,
            &query::Params { envs },
        );
        let matched = self.search.nearest(&self.gpu, &self.queries);
        let params = step::Params {
            envs,
            offset: self.offset(),
            max_steps: self.task.max_steps,
            reach: self.task.reach,
            bonus: self.task.bonus,
        };
        step::launch(
            &self.gpu,
            &self.candidates,
            matched,
            &self.motion,
            &self.real,
            &self.whole,
            &self.reward,
            &self.ended,
            &params,
        );
        self.see(&self.truncated, end::TRUNCATED);
        self.reset(false);
        self.clock += 1;
    }

    fn truncated(&mut self) -> Tensor<2> {
        from_buffer(&self.gpu, &self.truncated, [self.envs, OBSERVATION])
    }

    fn judge(&mut self, values: Values, gamma: f32, lambda: f32) -> (Tensor<1>, Tensor<1>) {
        let samples = self.horizon * self.envs;
        let advantage = Buffer::empty(&self.gpu, samples);
        let target = Buffer::empty(&self.gpu, samples);
        gae::launch(
            &self.gpu,
            &self.reward,
            &self.ended,
            &to_buffer(values.observed),
            &to_buffer(values.next),
            &to_buffer(values.last),
            &to_buffer(values.scale),
            &advantage,
            &target,
            &gae::Params {
                envs: self.envs as u32,
                steps: self.horizon as u32,
                gamma,
                lambda,
            },
        );
        (
            from_buffer(&self.gpu, &advantage, [samples]),
            from_buffer(&self.gpu, &target, [samples]),
        )
    }

    fn tally(&mut self) -> Tensor<1> {
        let sums = Buffer::empty(&self.gpu, 4);
        tally::launch(
            &self.gpu,
            &self.real,
            &self.whole,
            &sums,
            &tally::Params {
                envs: self.envs as u32,
            },
        );
        from_buffer(&self.gpu, &sums, [4])
    }

    fn snapshot(&self) -> anyhow::Result<Snapshot> {
        Ok(Snapshot {
            clock: self.clock,
            real: self.real.read(&self.gpu)?,
            whole: self.whole.read(&self.gpu)?,
        })
    }

    fn restore(&mut self, snapshot: &Snapshot) {
        self.clock = snapshot.clock;
        self.real = Buffer::from_slice(&self.gpu, &snapshot.real);
        self.whole = Buffer::from_slice(&self.gpu, &snapshot.whole);
    }
}

/// The search over the whole database, in the form that suits the adapter.
pub struct Search {
    /// `[candidates][PADDED]`, with half squares: see [`search_wide::with_half_square`].
    rows: Buffer<f32>,
    candidates: u32,
    count: u32,
    block: u32,
    longest: f32,
    /// `[blocks][count]`
    score: Buffer<f32>,
    matched: Buffer<u32>,
}

/// Rows a block at least: one tile of `search_tile`.
const BLOCK: u32 = 64;
/// Blocks at most: `search_exact` passes over all of them twice, and lavapipe silently stops after
/// 65,535 loop iterations.
const BLOCKS: u32 = 16_384;
/// Scores at most: WebGPU's default limit of 128 MiB a binding.
const SCORES: u32 = 1 << 25;
/// Blocks an invocation scores at most: enough work for each, enough invocations for all.
const RUN: u32 = 32;
/// Rows an invocation scores at most, for lavapipe's limit again.
const ROWS: u32 = 32_768;

impl Search {
    /// For batches of `count` queries.
    pub fn new(gpu: &Gpu, rows: &[[f32; PADDED]], count: usize) -> Self {
        let candidates = rows.len() as u32;
        let blocks = BLOCKS.min(SCORES / count as u32).max(1);
        let block = BLOCK * candidates.div_ceil(BLOCK * blocks);
        let halved: Vec<_> = rows.iter().map(search_wide::with_half_square).collect();
        let square = halved
            .iter()
            .map(|row| -2.0 * row[PADDED - 1])
            .fold(0.0, f32::max);
        Search {
            rows: Buffer::from_slice(gpu, halved.as_flattened()),
            candidates,
            count: count as u32,
            block,
            longest: square.sqrt(),
            score: Buffer::zeroed(gpu, candidates.div_ceil(block) as usize * count),
            matched: Buffer::zeroed(gpu, count),
        }
    }

    /// Nearest row of every query `[count][PADDED]`, whose last number must be 1.
    pub fn nearest(&self, gpu: &Gpu, queries: &Buffer<f32>) -> &Buffer<u32> {
        let Search {
            candidates,
            count,
            block,
            longest,
            ..
        } = *self;
        let run = (ROWS / block).clamp(1, RUN);
        if gpu.software {
            let params = search_wide::Params {
                count,
                candidates,
                block,
                run,
            };
            search_wide::launch(gpu, &self.rows, queries, &self.score, &params);
        } else {
            let params = search_tile::Params {
                count,
                candidates,
                block,
                run,
            };
            search_tile::launch(gpu, &self.rows, queries, &self.score, &params);
        }
        let params = search_exact::Params {
            count,
            candidates,
            block,
            longest,
        };
        search_exact::launch(
            gpu,
            &self.rows,
            queries,
            &self.score,
            &self.matched,
            &params,
        );
        &self.matched
    }
}
