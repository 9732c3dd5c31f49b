//! The task on a GPU: launches only, nothing copied to the host.

use super::common::Common;
use crate::container::{Section, SectionError};
use crate::env::humanoid::action::rest_action;
use crate::env::humanoid::batch::GpuSimulatorBatch;
use crate::env::spec::EnvSpec;
use crate::env::vec_env::{Transition, VecEnv};
use crate::gpu::{Array, Buffer, Gpu};
use crate::kernels::humanoid::stand_reward::{FIELDS, LIMIT, STATS, SUMS};
use crate::kernels::humanoid::{
    action_targets, draw_starts, episode_sums, random_pushes, stand_reward,
};
use crate::kernels::physics::proprioception;
use crate::kernels::termination;
use anyhow::Result;

pub struct GpuStand {
    gpu: Gpu,
    common: Common,
    batch: GpuSimulatorBatch,
    action_scale: Buffer<f32>,
    start_states: Buffer<f32>,
    characters: Buffer<u32>,
    /// `[FIELDS][envs]`
    episodes: Buffer<f32>,
    /// `[envs]`, how the last step ended.
    ended: Buffer<u32>,
}

impl GpuStand {
    /// `limits`, `[envs]`, are the lengths of the first episodes in steps.
    ///
    /// # Errors
    /// The model is too large for the shaders.
    pub fn new(common: Common, limits: &[f32], gpu: &Gpu) -> Result<GpuStand> {
        let envs = limits.len();
        let mut episodes = vec![0.0; FIELDS * envs];
        episodes[LIMIT * envs..][..envs].copy_from_slice(limits);
        let envs = GpuStand {
            batch: GpuSimulatorBatch::new(&common.batch, gpu)?,
            action_scale: Buffer::from_slice(gpu, &common.action_scale),
            start_states: Buffer::from_slice(gpu, &common.start_states),
            characters: Buffer::from_slice(gpu, &common.characters),
            episodes: Buffer::from_slice(gpu, &episodes),
            ended: Buffer::from_slice(gpu, &vec![termination::TRUNCATED; envs]),
            gpu: gpu.clone(),
            common,
        };
        envs.reset(0);
        Ok(envs)
    }

    /// Begins new episodes where the last step ended one.
    fn reset(&self, reset_counter: u32) {
        draw_starts::launch(
            &self.gpu,
            &self.ended,
            &self.start_states,
            &self.batch.starts,
            &self.common.draw_starts(reset_counter),
        );
        self.batch.reset_where(&self.ended);
    }

    /// Observes the environments whose step ended as `only` says, the kinematics being computed.
    fn observe_where(&self, only: u32, out: &Buffer<f32>, at: usize) {
        proprioception::launch(
            &self.gpu,
            &self.batch.model_table,
            &self.batch.state,
            &self.batch.poses,
            &self.batch.dynamics,
            &self.characters,
            &self.ended,
            out,
            &self.common.proprioception(at, only),
        );
    }
}

impl VecEnv for GpuStand {
    fn spec(&self) -> &EnvSpec {
        &self.common.spec
    }

    fn rest_action(&self) -> Vec<f32> {
        rest_action(&self.common.batch.model)
    }

    fn observe(&mut self, out: &mut Array, at: usize) {
        self.batch.kinematics();
        self.observe_where(proprioception::ANY, out.buffer(), at);
    }

    fn step(&mut self, action: &Array, at: usize, out: Transition) {
        action_targets::launch(
            &self.gpu,
            action.buffer(),
            &self.action_scale,
            &self.batch.targets,
            &self.common.action_targets(at),
        );
        random_pushes::launch(
            &self.gpu,
            &self.batch.external_forces,
            &self.common.random_pushes(),
        );
        self.batch.advance();
        self.batch.kinematics();
        stand_reward::launch(
            &self.gpu,
            &self.batch.state,
            &self.batch.poses,
            &self.episodes,
            out.reward.buffer(),
            out.termination.buffer(),
            &self.ended,
            &self.common.stand_reward(out.step * self.common.spec.envs),
        );
        self.observe_where(termination::TRUNCATED, out.final_observation.buffer(), 0);
        self.common.step_counter += 1;
        self.reset(self.common.step_counter);
    }

    fn stat_names(&self) -> &'static [&'static str] {
        &STATS
    }

    fn stats(&mut self, out: &mut Array) {
        episode_sums::launch(
            &self.gpu,
            &self.episodes,
            out.buffer(),
            &episode_sums::Params {
                envs: self.common.spec.envs as u32,
                start: SUMS as u32,
                fields: STATS.len() as u32,
            },
        );
    }

    fn save(&self, to: &mut Section) -> Result<()> {
        to.put("step_counter", self.common.step_counter);
        to.put_array("state", &self.batch.state.read(&self.gpu)?);
        to.put_array("warm_start", &self.batch.warm_start.read(&self.gpu)?);
        to.put_array("episodes", &self.episodes.read(&self.gpu)?);
        Ok(())
    }

    fn load(&mut self, from: &mut Section) -> Result<(), SectionError> {
        let step_counter = from.get("step_counter")?;
        let state = from.take_finite("state", self.batch.state.len())?;
        let warm_start: Vec<u32> = from.take_array("warm_start", self.batch.warm_start.len())?;
        let episodes = from.take_finite("episodes", self.episodes.len())?;
        self.common.step_counter = step_counter;
        self.batch.state = Buffer::from_slice(&self.gpu, &state);
        self.batch.warm_start = Buffer::from_slice(&self.gpu, &warm_start);
        self.episodes = Buffer::from_slice(&self.gpu, &episodes);
        Ok(())
    }
}
