//! A batch of worlds on the GPU: one launch after another on burn's own queue, nothing copied to
//! the host.

use super::kernel_params::KernelParams;
use crate::matching::gpu::Search;
use super::live_view::{Buffers, LiveView};
use super::{Setup, EnvState, Values, World};
use crate::gpu::tensor::{from_buffer, to_buffer};
use crate::gpu::{Buffer, Gpu};
use crate::kernels::locomotion::locomotion_layout::{VELOCITY_DIM, MAP_WORDS, boxes, state_f32, state_u32};
use crate::kernels::learn::{sample_action, gae};
use crate::kernels::locomotion::{obstacle_collision, hits, observe, build_query, reset, spawn_obstacles, rasterize_maps, advance_and_reward, episode_stats, move_obstacles};
use crate::motion::database::{Database, ROW_STRIDE};
use crate::motion::features::TRAJECTORY_DIM;
use burn::tensor::Tensor;

pub struct GpuLocomotion {
    gpu: Gpu,
    rules: KernelParams,
    candidates: Buffer<u32>,
    /// `[frames][ROW_STRIDE]`
    features: Buffer<f32>,
    motion: Buffer<f32>,
    /// `[frames][4]`
    path: Buffer<f32>,
    /// `[2][TRAJECTORY_DIM]`: mean and scale of the trajectory features.
    normal: Buffer<f32>,
    /// `[state_f32::FIELDS][envs]`, see [`crate::kernels::locomotion::locomotion_layout`].
    state_f32: Buffer<f32>,
    /// `[state_u32::FIELDS][envs]`
    state_u32: Buffer<u32>,
    /// `[envs][boxes::FIELDS][count]`
    boxes: Buffer<f32>,
    /// `[envs][VELOCITY_DIM][count]`
    obstacle_velocity: Buffer<f32>,
    /// `[envs][MAP_WORDS]`
    maps: Buffer<u32>,
    queries: Buffer<f32>,
    search: Search,
    reward: Buffer<f32>,
    termination: Buffer<u32>,
    /// `[final_steps][envs][width]`
    last: Buffer<f32>,
}

impl GpuLocomotion {
    /// Worlds at the start of an episode; the limits of these first episodes are up to `spread`
    /// early.
    pub fn new(gpu: &Gpu, database: &Database, setup: &Setup, initial_age_jitter: u32) -> Self {
        let (envs, rules) = (setup.envs, setup.rules(database));
        // Without obstacles a buffer still has to be bound.
        let count = setup.task.obstacles().max(1);
        let width = setup.task.width();
        let world = GpuLocomotion {
            candidates: Buffer::from_slice(gpu, &database.candidates),
            features: Buffer::from_slice(gpu, database.features.as_flattened()),
            motion: Buffer::from_slice(gpu, bytemuck::cast_slice(&database.motion)),
            path: Buffer::from_slice(gpu, database.path.as_flattened()),
            normal: Buffer::from_slice(gpu, &database.normalisation.trajectory()),
            state_f32: Buffer::zeroed(gpu, state_f32::FIELDS * envs),
            state_u32: Buffer::zeroed(gpu, state_u32::FIELDS * envs),
            boxes: Buffer::zeroed(gpu, envs * boxes::FIELDS * count),
            obstacle_velocity: Buffer::zeroed(gpu, envs * VELOCITY_DIM * count),
            maps: Buffer::zeroed(gpu, envs * MAP_WORDS),
            queries: Buffer::zeroed(gpu, envs * ROW_STRIDE),
            search: Search::new(gpu, database, envs),
            reward: Buffer::zeroed(gpu, setup.horizon * envs),
            termination: Buffer::zeroed(gpu, setup.horizon * envs),
            last: Buffer::zeroed(gpu, rules.final_steps() * envs * width),
            gpu: gpu.clone(),
            rules,
        };
        world.begin(true, initial_age_jitter);
        world
    }

    /// Starts new episodes, `everywhere` or where this step ended one.
    fn begin(&self, all: bool, initial_age_jitter: u32) {
        let obstacles = self.rules.task.obstacles() > 0;
        if obstacles {
            let params = self.rules.scatter(all);
            spawn_obstacles::launch(&self.gpu, &self.termination, &self.boxes, &self.obstacle_velocity, &params);
        }
        reset::launch(
            &self.gpu,
            &self.candidates,
            &self.termination,
            &self.boxes,
            &self.state_f32,
            &self.state_u32,
            &self.rules.reset(all, initial_age_jitter),
        );
        if obstacles {
            self.sense(true);
        }
    }

    fn sense(&self, just_reset: bool) {
        rasterize_maps::launch(
            &self.gpu,
            &self.boxes,
            &self.obstacle_velocity,
            &self.state_f32,
            &self.state_u32,
            &self.maps,
            &self.rules.sense(just_reset),
        );
    }

    fn see(&self, observation: &Buffer<f32>, params: &observe::Params) {
        observe::launch(
            &self.gpu,
            &self.features,
            &self.state_f32,
            &self.state_u32,
            &self.termination,
            &self.maps,
            observation,
            params,
        );
    }
}

impl World for GpuLocomotion {
    fn observe(&mut self) -> Tensor<2> {
        let shape = [self.rules.envs, self.rules.task.width()];
        let observation = Buffer::empty(&self.gpu, shape[0] * shape[1]);
        self.see(&observation, &self.rules.observe());
        from_buffer(&self.gpu, &observation, shape)
    }

    fn act(&mut self, mean: Tensor<2>, log_std: Tensor<1>) -> (Tensor<2>, Tensor<1>) {
        let envs = self.rules.envs;
        let action = Buffer::empty(&self.gpu, envs * TRAJECTORY_DIM);
        let log_prob = Buffer::empty(&self.gpu, envs);
        sample_action::launch(
            &self.gpu,
            &to_buffer(mean),
            &to_buffer(log_std),
            &action,
            &log_prob,
            &self.rules.act(),
        );
        (
            from_buffer(&self.gpu, &action, [envs, TRAJECTORY_DIM]),
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
                &self.state_f32,
                &self.state_u32,
                &self.rules.hits(),
            );
        }
        build_query::launch(
            &self.gpu,
            &self.features,
            &self.state_u32,
            &action,
            &self.queries,
            &self.rules.query(),
        );
        let matched = self.search.nearest(&self.gpu, &self.state_u32, &self.queries);
        if obstacles {
            obstacle_collision::launch(
                &self.gpu,
                &self.candidates,
                matched,
                &self.path,
                &self.boxes,
                &self.obstacle_velocity,
                &self.state_f32,
                &self.state_u32,
                &self.rules.collide(),
            );
            move_obstacles::launch(&self.gpu, &self.boxes, &self.obstacle_velocity, &self.rules.wander());
        }
        advance_and_reward::launch(
            &self.gpu,
            &self.candidates,
            matched,
            &self.motion,
            &self.state_f32,
            &self.state_u32,
            &self.reward,
            &self.termination,
            &self.rules.step(),
        );
        if obstacles {
            self.sense(false);
        }
        self.see(&self.last, &self.rules.observe_last());
        self.begin(false, 0);
        self.rules.step_counter += 1;
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
            &self.termination,
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
        let sums = Buffer::empty(&self.gpu, episode_stats::SUMS);
        let params = self.rules.tally();
        episode_stats::launch(&self.gpu, &self.state_f32, &self.state_u32, &sums, &params);
        from_buffer(&self.gpu, &sums, [episode_stats::SUMS])
    }

    fn set_level(&mut self, level: u32) {
        self.rules.level = level;
    }

    fn snapshot(&self) -> anyhow::Result<EnvState> {
        let count = self.rules.task.obstacles();
        let (mut boxes, mut obstacle_velocity) = (self.boxes.read(&self.gpu)?, self.obstacle_velocity.read(&self.gpu)?);
        boxes.truncate(self.rules.envs * boxes::FIELDS * count);
        obstacle_velocity.truncate(self.rules.envs * VELOCITY_DIM * count);
        Ok(EnvState {
            step_counter: self.rules.step_counter,
            level: self.rules.level,
            state_f32: self.state_f32.read(&self.gpu)?,
            state_u32: self.state_u32.read(&self.gpu)?,
            boxes,
            obstacle_velocity,
            maps: self.maps.read(&self.gpu)?,
        })
    }

    fn watch(&mut self) -> anyhow::Result<LiveView> {
        Ok(LiveView::Gpu(Box::new(Buffers {
            state_f32: self.state_f32.share(&self.gpu)?,
            state_u32: self.state_u32.share(&self.gpu)?,
            boxes: match self.rules.task.obstacles() {
                0 => None,
                _ => Some(self.boxes.share(&self.gpu)?),
            },
        })))
    }

    fn restore(&mut self, snapshot: &EnvState) {
        (self.rules.step_counter, self.rules.level) = (snapshot.step_counter, snapshot.level);
        self.state_f32 = Buffer::from_slice(&self.gpu, &snapshot.state_f32);
        self.state_u32 = Buffer::from_slice(&self.gpu, &snapshot.state_u32);
        self.maps = Buffer::from_slice(&self.gpu, &snapshot.maps);
        if self.rules.task.obstacles() > 0 {
            self.boxes = Buffer::from_slice(&self.gpu, &snapshot.boxes);
            self.obstacle_velocity = Buffer::from_slice(&self.gpu, &snapshot.obstacle_velocity);
        }
    }
}
