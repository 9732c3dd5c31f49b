//! Environments on a GPU: one launch after another on burn's own queue, nothing copied to the host.

use super::config::{EnvConfig, STAT_NAMES};
use super::env_state::EnvState;
use super::kernel_params::KernelParams;
use crate::container::{Section, SectionError};
use crate::env::live_view::{Buffers, LiveView, LocomotionView};
use crate::env::spec::EnvSpec;
use crate::env::vec_env::{Transition, VecEnv};
use crate::gpu::{Array, Buffer, Gpu};
use crate::kernels::locomotion::locomotion_layout::{
    MAP_WORDS, VELOCITY_DIM, boxes, state_f32, state_u32,
};
use crate::kernels::locomotion::{
    advance_and_reward, build_query, episode_stats, hits, move_obstacles, observe,
    obstacle_collision, rasterize_maps, reset, spawn_obstacles,
};
use crate::kernels::termination::restarted;
use crate::matching::MotionMatcher;
use crate::matching::gpu::GpuSearch;
use crate::motion::features::ROW_STRIDE;
use anyhow::Result;

/// A batch of locomotion environments on a GPU.
pub struct GpuLocomotion {
    gpu: Gpu,
    spec: EnvSpec,
    params: KernelParams,
    /// Frames of the database.
    frames: usize,
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
    /// `[envs][ROW_STRIDE]`
    queries: Buffer<f32>,
    search: GpuSearch,
    /// `[envs]`, all zero: the terminations where no step has been played.
    running: Buffer<u32>,
}

impl GpuLocomotion {
    /// Environments at the start of an episode, the first of which has the number `first` in the whole batch; the limits
    /// of their first episodes are up to `initial_age_jitter` steps early.
    pub fn new(
        gpu: &Gpu,
        matcher: &MotionMatcher,
        config: &EnvConfig,
        first: usize,
        initial_age_jitter: u32,
    ) -> Self {
        let (envs, database) = (config.envs, &matcher.database);
        // Without obstacles a buffer still has to be bound.
        let count = config.task.obstacles().max(1);
        let batch = GpuLocomotion {
            spec: config.spec(),
            params: KernelParams::new(config, first, database.candidates.len()),
            frames: database.frames(),
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
            search: GpuSearch::new(gpu, matcher, envs),
            running: Buffer::zeroed(gpu, envs),
            gpu: gpu.clone(),
        };
        batch.reset(&batch.running, true, initial_age_jitter);
        batch
    }

    /// Starts new episodes, in `all` environments or where this step ended one.
    fn reset(&self, termination: &Buffer<u32>, all: bool, initial_age_jitter: u32) {
        let obstacles = self.params.task.obstacles() > 0;
        if obstacles {
            spawn_obstacles::launch(
                &self.gpu,
                termination,
                &self.boxes,
                &self.obstacle_velocity,
                &self.params.spawn_obstacles(all),
            );
        }
        reset::launch(
            &self.gpu,
            &self.candidates,
            termination,
            &self.boxes,
            &self.state_f32,
            &self.state_u32,
            &self.params.reset(all, initial_age_jitter),
        );
        if obstacles {
            self.rasterize_maps(true);
        }
    }

    fn rasterize_maps(&self, just_reset: bool) {
        rasterize_maps::launch(
            &self.gpu,
            &self.boxes,
            &self.obstacle_velocity,
            &self.state_f32,
            &self.state_u32,
            &self.maps,
            &self.params.rasterize_maps(just_reset),
        );
    }

    fn write_observation(
        &self,
        termination: &Buffer<u32>,
        observation: &Buffer<f32>,
        params: &observe::Params,
    ) {
        observe::launch(
            &self.gpu,
            &self.features,
            &self.state_f32,
            &self.state_u32,
            termination,
            &self.maps,
            observation,
            params,
        );
    }

    /// Finds the nearest candidates of the queries that the actions complete.
    fn search(&self, action: &Buffer<f32>, at: usize) -> &Buffer<u32> {
        build_query::launch(
            &self.gpu,
            &self.features,
            &self.state_u32,
            action,
            &self.queries,
            &self.params.build_query(at),
        );
        self.search
            .nearest(&self.gpu, &self.state_u32, &self.queries)
    }

    fn hits(&self, action: &Buffer<f32>, at: usize) {
        hits::launch(
            &self.gpu,
            action,
            &self.normal,
            &self.boxes,
            &self.state_f32,
            &self.state_u32,
            &self.params.hits(at),
        );
    }

    fn move_obstacles(&self, matched: &Buffer<u32>) {
        obstacle_collision::launch(
            &self.gpu,
            &self.candidates,
            matched,
            &self.path,
            &self.boxes,
            &self.obstacle_velocity,
            &self.state_f32,
            &self.state_u32,
            &self.params.obstacle_collision(),
        );
        move_obstacles::launch(
            &self.gpu,
            &self.boxes,
            &self.obstacle_velocity,
            &self.params.move_obstacles(),
        );
    }
}

impl VecEnv for GpuLocomotion {
    fn spec(&self) -> &EnvSpec {
        &self.spec
    }

    fn observe(&mut self, out: &mut Array, at: usize) {
        let row = at / self.params.observation_dim();
        self.params.offset = 0;
        self.write_observation(&self.running, out.buffer(), &self.params.observe(row));
    }

    fn step(&mut self, action: &Array, at: usize, out: Transition) {
        let obstacles = self.params.task.obstacles() > 0;
        let (action, termination) = (action.buffer(), out.termination.buffer());
        self.params.offset = out.step * self.params.envs;
        if obstacles {
            self.hits(action, at);
        }
        let matched = self.search(action, at);
        if obstacles {
            self.move_obstacles(matched);
        }
        advance_and_reward::launch(
            &self.gpu,
            &self.candidates,
            matched,
            &self.motion,
            &self.state_f32,
            &self.state_u32,
            out.reward.buffer(),
            termination,
            &self.params.advance_and_reward(),
        );
        if obstacles {
            self.rasterize_maps(false);
        }
        let params = self.params.observe_final(self.spec.final_row(out.step));
        self.write_observation(termination, out.final_observation.buffer(), &params);
        self.reset(termination, false, 0);
        self.params.step_counter += 1;
    }

    fn stat_names(&self) -> &'static [&'static str] {
        &STAT_NAMES
    }

    fn stats(&mut self, out: &mut Array) {
        let params = self.params.episode_stats();
        episode_stats::launch(
            &self.gpu,
            &self.state_f32,
            &self.state_u32,
            out.buffer(),
            &params,
        );
    }

    fn restart(&mut self, which: &[bool]) -> Result<()> {
        let restarted = Buffer::from_slice(&self.gpu, &restarted(which));
        self.params.offset = 0;
        self.reset(&restarted, false, 0);
        self.params.step_counter += 1;
        Ok(())
    }

    fn set_level(&mut self, level: u32) {
        self.params.level = level;
    }

    fn live_view(&mut self) -> Result<Option<LiveView>> {
        let buffers = Buffers {
            state_f32: self.state_f32.share(&self.gpu)?,
            state_u32: self.state_u32.share(&self.gpu)?,
            boxes: match self.params.task.obstacles() {
                0 => None,
                _ => Some(self.boxes.share(&self.gpu)?),
            },
        };
        let view = LocomotionView::Gpu(Box::new(buffers));
        Ok(Some(LiveView::Locomotion(view)))
    }

    fn save(&self, to: &mut Section) -> Result<()> {
        let (envs, count) = (self.params.envs, self.params.task.obstacles());
        let mut boxes = self.boxes.read(&self.gpu)?;
        let mut obstacle_velocity = self.obstacle_velocity.read(&self.gpu)?;
        boxes.truncate(envs * boxes::FIELDS * count);
        obstacle_velocity.truncate(envs * VELOCITY_DIM * count);
        EnvState {
            step_counter: self.params.step_counter,
            level: self.params.level,
            state_f32: self.state_f32.read(&self.gpu)?,
            state_u32: self.state_u32.read(&self.gpu)?,
            boxes,
            obstacle_velocity,
            maps: self.maps.read(&self.gpu)?,
        }
        .save(to);
        Ok(())
    }

    fn load(&mut self, from: &mut Section) -> Result<(), SectionError> {
        let (envs, count) = (self.params.envs, self.params.task.obstacles());
        let state = EnvState::load(from, envs, count, self.frames)?;
        (self.params.step_counter, self.params.level) = (state.step_counter, state.level);
        self.state_f32 = Buffer::from_slice(&self.gpu, &state.state_f32);
        self.state_u32 = Buffer::from_slice(&self.gpu, &state.state_u32);
        self.maps = Buffer::from_slice(&self.gpu, &state.maps);
        if count > 0 {
            self.boxes = Buffer::from_slice(&self.gpu, &state.boxes);
            self.obstacle_velocity = Buffer::from_slice(&self.gpu, &state.obstacle_velocity);
        }
        Ok(())
    }
}
