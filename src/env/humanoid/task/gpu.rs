//! A task on a GPU: launches only, nothing copied to the host.

use super::common::Common;
use super::humanoid_task::{GpuHumanoidTask, StepContext, TaskBuffers};
use crate::container::{Section, SectionError};
use crate::env::body_view::{BodyBuffers, BodyView, BodyWorlds};
use crate::env::humanoid::batch::{GpuSimulatorBatch, SimulatorBatch};
use crate::env::live_view::LiveView;
use crate::env::spec::EnvSpec;
use crate::env::vec_env::{Transition, VecEnv};
use crate::gpu::{Array, Buffer, Device, Gpu};
use crate::kernels::humanoid::end_episode::{self, LIMIT, fields, sums_at};
use crate::kernels::humanoid::{action_targets, draw_starts, episode_sums};
use crate::kernels::physics::proprioception;
use crate::kernels::physics::solve_and_integrate::{warm_start_dim, warm_start_room, with_room};
use crate::kernels::physics::strided::{gather, scatter};
use crate::kernels::termination::{self, restarted};
use anyhow::Result;

pub struct GpuHumanoidEnv {
    common: Common,
    task: Box<dyn GpuHumanoidTask>,
    worlds: TaskBuffers,
    action_scale: Buffer<f32>,
    start_states: Buffer<f32>,
    characters: Buffer<u32>,
    /// `[fields][rows]`, see [`end_episode`].
    episodes: Buffer<f32>,
}

impl GpuHumanoidEnv {
    /// `limits`, `[envs]`, are the lengths of the first episodes in steps.
    ///
    /// # Errors
    /// The model is too large for the shaders.
    pub fn new(common: Common, limits: &[f32], gpu: &Gpu) -> Result<GpuHumanoidEnv> {
        let (envs, rows) = (limits.len(), common.spec.rows());
        let mut episodes = vec![0.0; fields(common.measures) * rows];
        for (row, limit) in episodes[LIMIT * rows..][..rows].iter_mut().enumerate() {
            *limit = limits[row / common.spec.agents];
        }
        // A buffer has at least one number.
        let zeros = |fields: usize, columns: usize| Buffer::zeroed(gpu, fields.max(1) * columns);
        let envs = GpuHumanoidEnv {
            task: common.task.on_gpu(gpu),
            worlds: TaskBuffers {
                batch: GpuSimulatorBatch::new(&common.batch, gpu)?,
                state: zeros(common.task.state_dim(), envs),
                measures: zeros(common.measures, rows),
                task_end: Buffer::zeroed(gpu, rows),
                ended: Buffer::from_slice(gpu, &vec![termination::TRUNCATED; envs]),
                gpu: gpu.clone(),
            },
            action_scale: Buffer::from_slice(gpu, &common.action_scale),
            start_states: Buffer::from_slice(gpu, common.task.start_states()),
            characters: Buffer::from_slice(gpu, &common.characters),
            episodes: Buffer::from_slice(gpu, &episodes),
            common,
        };
        envs.reset(&envs.common.moment());
        Ok(envs)
    }

    /// Begins new episodes where the last step ended one.
    fn reset(&self, moment: &StepContext) {
        let worlds = &self.worlds;
        draw_starts::launch(
            &worlds.gpu,
            &worlds.ended,
            &self.start_states,
            &worlds.batch.starts,
            &self.common.draw_starts(moment),
        );
        self.task.begin(worlds, moment);
        worlds.batch.reset_where(&worlds.ended);
    }

    /// Observes the environments whose step ended as one of `only`, the kinematics being computed.
    fn observe_where(&self, only: u32, out: &Buffer<f32>, at: usize) {
        let worlds = &self.worlds;
        proprioception::launch(
            &worlds.gpu,
            &worlds.batch.model_table,
            &worlds.batch.state,
            &worlds.batch.poses,
            &worlds.batch.dynamics,
            &self.characters,
            &worlds.ended,
            out,
            &self.common.proprioception(at, only),
        );
        let width = self.common.spec.observation.dim();
        let at = at + self.common.body_dim();
        self.task.observe(worlds, out, at, width, only);
    }
}

impl VecEnv for GpuHumanoidEnv {
    fn spec(&self) -> &EnvSpec {
        &self.common.spec
    }

    fn rest_action(&self) -> Vec<f32> {
        self.common.task.rest_action()
    }

    fn observe(&mut self, out: &mut Array, at: usize) {
        self.worlds.batch.kinematics();
        self.observe_where(termination::ANY, out.buffer(), at);
    }

    fn step(&mut self, action: &Array, at: usize, out: Transition) {
        let (worlds, moment) = (&self.worlds, self.common.moment());
        action_targets::launch(
            &worlds.gpu,
            action.buffer(),
            &self.action_scale,
            &worlds.batch.targets,
            &self.common.action_targets(at),
        );
        self.task.act(worlds, &moment);
        worlds.batch.advance();
        worlds.batch.kinematics();
        let at = out.step * self.common.spec.rows();
        let (reward, group) = (out.reward.buffer(), out.group.buffer());
        self.task.reward(worlds, reward, group, at, &moment);
        end_episode::launch(
            &worlds.gpu,
            &worlds.batch.state,
            &worlds.batch.poses,
            &worlds.measures,
            &worlds.task_end,
            &self.episodes,
            out.reward.buffer(),
            out.termination.buffer(),
            &worlds.ended,
            &self.common.end_episode(at),
        );
        let spec = &self.common.spec;
        let at = spec.final_row(out.step) * spec.observation.dim();
        let ended = termination::ANY & !(1 << termination::RUNNING);
        self.observe_where(ended, out.final_observation.buffer(), at);
        self.common.step_counter += 1;
        self.reset(&self.common.moment());
    }

    fn stat_names(&self) -> &'static [&'static str] {
        self.common.task.stat_names()
    }

    fn stats(&mut self, out: &mut Array) {
        episode_sums::launch(
            &self.worlds.gpu,
            &self.episodes,
            out.buffer(),
            &episode_sums::Params {
                envs: self.common.spec.rows() as u32,
                start: sums_at(self.common.measures) as u32,
                fields: self.stat_names().len() as u32,
            },
        );
    }

    fn row_stats(&self) -> Option<Array> {
        let rows = self.common.spec.rows();
        let range = sums_at(self.common.measures) * rows..self.episodes.len();
        let device = Device::from(self.worlds.gpu.clone());
        Some(Array::Gpu(self.episodes.clone()).copy(&device, range))
    }

    fn restart(&mut self, which: &[bool]) -> Result<()> {
        let (common, worlds) = (&mut self.common, &mut self.worlds);
        let (rows, params) = (common.spec.rows(), common.end_episode(0));
        let mut episodes = self.episodes.read(&worlds.gpu)?;
        let mut own = vec![0.0; fields(common.measures)];
        for row in (0..rows).filter(|row| which[row / common.spec.agents]) {
            gather(&episodes, rows, row, 0, &mut own);
            end_episode::begin(&mut own, &params);
            scatter(&mut episodes, rows, row, 0, &own);
        }
        self.episodes = Buffer::from_slice(&worlds.gpu, &episodes);
        worlds.ended = Buffer::from_slice(&worlds.gpu, &restarted(which));
        common.step_counter += 1;
        self.reset(&self.common.moment());
        Ok(())
    }

    fn live_view(&mut self) -> Result<Option<LiveView>> {
        let (batch, gpu) = (&self.worlds.batch, &self.worlds.gpu);
        let buffers = BodyBuffers {
            envs: self.common.spec.envs,
            poses: batch.poses.share(gpu)?,
            starts: batch.starts.share(gpu)?,
        };
        Ok(Some(LiveView::Bodies(BodyView {
            model: self.common.batch.model.clone(),
            worlds: BodyWorlds::Gpu(Box::new(buffers)),
        })))
    }

    fn contact_overflow(&self) -> Result<u64> {
        Ok(self.worlds.batch.counters()?.overflow)
    }

    fn save(&self, to: &mut Section) -> Result<()> {
        let (worlds, gpu) = (&self.worlds, &self.worlds.gpu);
        to.put("step_counter", self.common.step_counter);
        to.put_array("state", &worlds.batch.state.read(gpu)?);
        to.put_array("warm_start", &worlds.batch.warm_start.read(gpu)?);
        to.put_array("episodes", &self.episodes.read(gpu)?);
        let task_state = self.common.task.state_dim() * self.common.spec.envs;
        to.put_array("task_state", &worlds.state.read(gpu)?[..task_state]);
        Ok(())
    }

    fn load(&mut self, from: &mut Section) -> Result<(), SectionError> {
        let (worlds, envs) = (&mut self.worlds, self.common.spec.envs);
        let step_counter = from.get("step_counter")?;
        let state = from.take_finite("state", worlds.batch.state.len())?;
        let (model, own) = (
            &self.common.batch.model,
            self.common.batch.options.max_contacts,
        );
        let joints = model.joints.len();
        let room = warm_start_room(from.array_len("warm_start") / envs, joints);
        let warm_start: Vec<u32> =
            from.take_array("warm_start", warm_start_dim(room, joints) * envs)?;
        let warm_start = with_room(model, &warm_start, envs, [room, own]);
        let episodes = from.take_finite("episodes", self.episodes.len())?;
        let task_state = self.common.task.state_dim() * envs;
        let mut task_state = from.take_finite("task_state", task_state)?;
        task_state.resize(worlds.state.len(), 0.0);
        self.common.step_counter = step_counter;
        worlds.batch.state = Buffer::from_slice(&worlds.gpu, &state);
        worlds.batch.warm_start = Buffer::from_slice(&worlds.gpu, &warm_start);
        worlds.state = Buffer::from_slice(&worlds.gpu, &task_state);
        self.episodes = Buffer::from_slice(&worlds.gpu, &episodes);
        Ok(())
    }
}
