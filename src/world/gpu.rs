//! A batch of worlds on the GPU: one launch after another on burn's own queue, nothing copied to
//! the host.

use super::rules::Rules;
use super::search::Search;
use super::watched::{Buffers, Watched};
use super::{Setup, Snapshot, Values, World};
use crate::gpu::tensor::{from_buffer, to_buffer};
use crate::gpu::{Buffer, Gpu};
use crate::kernels::layout::{AXES, MAP_WORDS, boxes, real, whole};
use crate::kernels::{
    act, collide, gae, hits, observe, query, reset, scatter, sense, step, tally, wander,
};
use crate::motion::database::{Database, PADDED};
use crate::motion::features::TRAJECTORY;
use burn::tensor::Tensor;

pub struct GpuWorld {
    gpu: Gpu,
    rules: Rules,
    candidates: Buffer<u32>,
    /// `[frames][PADDED]`
    features: Buffer<f32>,
    motion: Buffer<f32>,
    /// `[frames][4]`
    path: Buffer<f32>,
    /// `[2][TRAJECTORY]`: mean and scale of the trajectory features.
    normal: Buffer<f32>,
    /// `[real::FIELDS][envs]`, see [`crate::kernels::layout`].
    real: Buffer<f32>,
    /// `[whole::FIELDS][envs]`
    whole: Buffer<u32>,
    /// `[envs][boxes::FIELDS][count]`
    boxes: Buffer<f32>,
    /// `[envs][AXES][count]`
    drift: Buffer<f32>,
    /// `[envs][MAP_WORDS]`
    maps: Buffer<u32>,
    queries: Buffer<f32>,
    search: Search,
    reward: Buffer<f32>,
    ended: Buffer<u32>,
    /// `[final_steps][envs][width]`
    last: Buffer<f32>,
}

impl GpuWorld {
    /// Worlds at the start of an episode; the limits of these first episodes are up to `spread`
    /// early.
    pub fn new(gpu: &Gpu, database: &Database, setup: &Setup, spread: u32) -> Self {
        let (envs, rules) = (setup.envs, setup.rules(database));
        // Without obstacles a buffer still has to be bound.
        let count = setup.task.obstacles().max(1);
        let width = setup.task.width();
        let world = GpuWorld {
            candidates: Buffer::from_slice(gpu, &database.candidates),
            features: Buffer::from_slice(gpu, database.features.as_flattened()),
            motion: Buffer::from_slice(gpu, bytemuck::cast_slice(&database.motion)),
            path: Buffer::from_slice(gpu, database.path.as_flattened()),
            normal: Buffer::from_slice(gpu, &database.normalisation.trajectory()),
            real: Buffer::zeroed(gpu, real::FIELDS * envs),
            whole: Buffer::zeroed(gpu, whole::FIELDS * envs),
            boxes: Buffer::zeroed(gpu, envs * boxes::FIELDS * count),
            drift: Buffer::zeroed(gpu, envs * AXES * count),
            maps: Buffer::zeroed(gpu, envs * MAP_WORDS),
            queries: Buffer::zeroed(gpu, envs * PADDED),
            search: Search::new(gpu, database, envs),
            reward: Buffer::zeroed(gpu, setup.horizon * envs),
            ended: Buffer::zeroed(gpu, setup.horizon * envs),
            last: Buffer::zeroed(gpu, rules.final_steps() * envs * width),
            gpu: gpu.clone(),
            rules,
        };
        world.begin(true, spread);
        world
    }

    /// Starts new episodes, `everywhere` or where this step ended one.
    fn begin(&self, everywhere: bool, spread: u32) {
        let obstacles = self.rules.task.obstacles() > 0;
        if obstacles {
            let params = self.rules.scatter(everywhere);
            scatter::launch(&self.gpu, &self.ended, &self.boxes, &self.drift, &params);
        }
        reset::launch(
            &self.gpu,
            &self.candidates,
            &self.ended,
            &self.boxes,
            &self.real,
            &self.whole,
            &self.rules.reset(everywhere, spread),
        );
        if obstacles {
            self.sense(true);
        }
    }

    fn sense(&self, begun: bool) {
        sense::launch(
            &self.gpu,
            &self.boxes,
            &self.drift,
            &self.real,
            &self.whole,
            &self.maps,
            &self.rules.sense(begun),
        );
    }

    fn see(&self, observation: &Buffer<f32>, params: &observe::Params) {
        observe::launch(
            &self.gpu,
            &self.features,
            &self.real,
            &self.whole,
            &self.ended,
            &self.maps,
            observation,
            params,
        );
    }
}

impl World for GpuWorld {
    fn observe(&mut self) -> Tensor<2> {
        let shape = [self.rules.envs, self.rules.task.width()];
        let observation = Buffer::empty(&self.gpu, shape[0] * shape[1]);
        self.see(&observation, &self.rules.observe());
        from_buffer(&self.gpu, &observation, shape)
    }

    fn act(&mut self, mean: Tensor<2>, log_std: Tensor<1>) -> (Tensor<2>, Tensor<1>) {
        let envs = self.rules.envs;
        let action = Buffer::empty(&self.gpu, envs * TRAJECTORY);
        let log_prob = Buffer::empty(&self.gpu, envs);
        act::launch(
            &self.gpu,
            &to_buffer(mean),
            &to_buffer(log_std),
            &action,
            &log_prob,
            &self.rules.act(),
        );
        (
            from_buffer(&self.gpu, &action, [envs, TRAJECTORY]),
            from_buffer(&self.gpu, &log_prob, [envs]),
        )
    }

    fn step(&mut self, action: Tensor<2>) {
        let obstacles = self.rules.task.obstacles() > 0;
        let action = to_buffer(action);
        if obstacles {
            hits::launch(
                &self.gpu,
                &action,
                &self.normal,
                &self.boxes,
                &self.real,
                &self.whole,
                &self.rules.hits(),
            );
        }
        query::launch(
            &self.gpu,
            &self.features,
            &self.whole,
            &action,
            &self.queries,
            &self.rules.query(),
        );
        let matched = self.search.nearest(&self.gpu, &self.whole, &self.queries);
        if obstacles {
            collide::launch(
                &self.gpu,
                &self.candidates,
                matched,
                &self.path,
                &self.boxes,
                &self.drift,
                &self.real,
                &self.whole,
                &self.rules.collide(),
            );
            wander::launch(&self.gpu, &self.boxes, &self.drift, &self.rules.wander());
        }
        step::launch(
            &self.gpu,
            &self.candidates,
            matched,
            &self.motion,
            &self.real,
            &self.whole,
            &self.reward,
            &self.ended,
            &self.rules.step(),
        );
        if obstacles {
            self.sense(false);
        }
        self.see(&self.last, &self.rules.observe_last());
        self.begin(false, 0);
        self.rules.clock += 1;
    }

    fn last(&mut self) -> Tensor<2> {
        let width = self.rules.task.width();
        from_buffer(&self.gpu, &self.last, [self.last.len() / width, width])
    }

    fn judge(&mut self, values: Values, gamma: f32, lambda: f32) -> (Tensor<1>, Tensor<1>) {
        let samples = self.reward.len();
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
            &self.rules.gae(gamma, lambda),
        );
        (
            from_buffer(&self.gpu, &advantage, [samples]),
            from_buffer(&self.gpu, &target, [samples]),
        )
    }

    fn tally(&mut self) -> Tensor<1> {
        let sums = Buffer::empty(&self.gpu, tally::SUMS);
        let params = self.rules.tally();
        tally::launch(&self.gpu, &self.real, &self.whole, &sums, &params);
        from_buffer(&self.gpu, &sums, [tally::SUMS])
    }

    fn set_level(&mut self, level: u32) {
        self.rules.level = level;
    }

    fn snapshot(&self) -> anyhow::Result<Snapshot> {
        let count = self.rules.task.obstacles();
        let (mut boxes, mut drift) = (self.boxes.read(&self.gpu)?, self.drift.read(&self.gpu)?);
        boxes.truncate(self.rules.envs * boxes::FIELDS * count);
        drift.truncate(self.rules.envs * AXES * count);
        Ok(Snapshot {
            clock: self.rules.clock,
            level: self.rules.level,
            real: self.real.read(&self.gpu)?,
            whole: self.whole.read(&self.gpu)?,
            boxes,
            drift,
            maps: self.maps.read(&self.gpu)?,
        })
    }

    fn watch(&mut self) -> anyhow::Result<Watched> {
        Ok(Watched::Gpu(Box::new(Buffers {
            real: self.real.share(&self.gpu)?,
            whole: self.whole.share(&self.gpu)?,
            boxes: match self.rules.task.obstacles() {
                0 => None,
                _ => Some(self.boxes.share(&self.gpu)?),
            },
        })))
    }

    fn restore(&mut self, snapshot: &Snapshot) {
        (self.rules.clock, self.rules.level) = (snapshot.clock, snapshot.level);
        self.real = Buffer::from_slice(&self.gpu, &snapshot.real);
        self.whole = Buffer::from_slice(&self.gpu, &snapshot.whole);
        self.maps = Buffer::from_slice(&self.gpu, &snapshot.maps);
        if self.rules.task.obstacles() > 0 {
            self.boxes = Buffer::from_slice(&self.gpu, &snapshot.boxes);
            self.drift = Buffer::from_slice(&self.gpu, &snapshot.drift);
        }
    }
}
