//! The task on all cores: each world plays its step from beginning to end while it is in the cache.

use super::common::Common;
use crate::container::{Section, SectionError};
use crate::env::humanoid::action::rest_action;
use crate::env::humanoid::batch::{CpuSimulatorBatch, SimulatedWorld, SimulatorBatch};
use crate::env::spec::EnvSpec;
use crate::env::vec_env::{Transition, VecEnv};
use crate::gpu::Array;
use crate::kernels::humanoid::action_targets::set_targets;
use crate::kernels::humanoid::draw_starts::{self, start};
use crate::kernels::humanoid::random_pushes::{self, push};
use crate::kernels::humanoid::stand_reward::{self, Episode, FIELDS, LIMIT, STATS, SUMS};
use crate::kernels::physics::proprioception;
use crate::kernels::physics::smooth_dynamics;
use crate::kernels::physics::solve_and_integrate::{
    read_warm_start, warm_start_dim, write_warm_start,
};
use crate::kernels::physics::strided::{gather, scatter};
use crate::kernels::termination;
use crate::physics::simulator::Simulator;
use anyhow::Result;

pub struct CpuStand {
    pub common: Common,
    pub batch: CpuSimulatorBatch,
    /// `[envs]`
    pub episodes: Vec<Episode>,
    /// `[envs][observation]` of this moment.
    observation: Vec<f32>,
}

/// What a world reads and writes in a step.
struct Row<'a> {
    action: &'a [f32],
    episode: &'a mut Episode,
    reward: &'a mut f32,
    termination: &'a mut u32,
    final_observation: &'a mut [f32],
    observation: &'a mut [f32],
}

/// Parameters of a step's kernels.
struct StepParams {
    pushes: random_pushes::Params,
    reward: stand_reward::Params,
    starts: draw_starts::Params,
}

impl CpuStand {
    /// `limits`, `[envs]`, are the lengths of the first episodes in steps.
    pub fn new(common: Common, limits: &[f32]) -> CpuStand {
        let mut batch = CpuSimulatorBatch::new(&common.batch);
        let params = common.draw_starts(0);
        for (env, world) in batch.worlds.iter_mut().enumerate() {
            let start = start(&common.start_states, env, &params);
            world.start.copy_from_slice(start);
            world.reset();
        }
        let mut episodes = vec![[0.0; FIELDS]; limits.len()];
        for (episode, &limit) in episodes.iter_mut().zip(limits) {
            episode[LIMIT] = limit;
        }
        let observation = vec![0.0; limits.len() * common.spec.observation.dim()];
        let mut envs = CpuStand {
            common,
            batch,
            episodes,
            observation,
        };
        envs.observe_all();
        envs
    }

    fn observe_all(&mut self) {
        let (common, dim) = (&self.common, self.common.spec.observation.dim());
        let mut rows: Vec<&mut [f32]> = self.observation.chunks_exact_mut(dim).collect();
        self.batch.each(&mut rows, |_, simulator, world, row| {
            simulator.kinematics(&world.state.q, &world.state.v);
            common.observe(simulator, world, row);
        });
    }
}

impl Common {
    /// Observes a world whose kinematics the simulator has computed.
    fn observe(&self, simulator: &Simulator, world: &SimulatedWorld, out: &mut [f32]) {
        proprioception::observe(
            &simulator.model,
            &world.state.q,
            &world.state.v,
            &simulator.poses,
            &simulator.velocities,
            &self.characters[1..],
            out,
        );
    }

    /// Plays one step of a world.
    fn play(
        &self,
        env: usize,
        simulator: &mut Simulator,
        world: &mut SimulatedWorld,
        row: &mut Row,
        params: &StepParams,
    ) {
        set_targets(row.action, &self.action_scale, &mut world.targets);
        let [x, y] = push(env, &params.pushes);
        let force = &mut world.external_forces[params.pushes.body as usize].linear;
        (force.x, force.y) = (x, y);
        world.advance(simulator, &[]);
        let SimulatedWorld { state, .. } = world;
        simulator.kinematics(&state.q, &state.v);
        let poses = &simulator.poses;
        let (reward, end) =
            stand_reward::step(&state.q, &state.v, poses, row.episode, &params.reward);
        (*row.reward, *row.termination) = (reward, end);
        if end == termination::TRUNCATED {
            self.observe(simulator, world, row.final_observation);
        }
        if end != termination::RUNNING {
            let start = start(&self.start_states, env, &params.starts);
            world.start.copy_from_slice(start);
            world.reset();
            simulator.kinematics(&world.state.q, &world.state.v);
        }
        self.observe(simulator, world, row.observation);
    }
}

impl VecEnv for CpuStand {
    fn spec(&self) -> &EnvSpec {
        &self.common.spec
    }

    fn rest_action(&self) -> Vec<f32> {
        rest_action(&self.common.batch.model)
    }

    fn observe(&mut self, out: &mut Array, at: usize) {
        out.host_mut()[at..][..self.observation.len()].copy_from_slice(&self.observation);
    }

    fn step(&mut self, action: &Array, at: usize, out: Transition) {
        let (envs, dim) = (self.common.spec.envs, self.common.spec.observation.dim());
        let counter = self.common.step_counter;
        let params = StepParams {
            pushes: self.common.random_pushes(),
            reward: self.common.stand_reward(0),
            starts: self.common.draw_starts(counter + 1),
        };
        let actions = action.host()[at..].chunks_exact(self.common.spec.action);
        let rewards = &mut out.reward.host_mut()[out.step * envs..][..envs];
        let terminations = &mut out.termination.host_mut()[out.step * envs..][..envs];
        let finals = out.final_observation.host_mut().chunks_exact_mut(dim);
        let observations = self.observation.chunks_exact_mut(dim);
        let rows = actions.zip(&mut self.episodes).zip(rewards);
        let rows = rows.zip(terminations).zip(finals).zip(observations);
        let mut rows: Vec<Row> = rows
            .map(
                |(((((action, episode), reward), termination), last), observation)| Row {
                    action,
                    episode,
                    reward,
                    termination,
                    final_observation: last,
                    observation,
                },
            )
            .collect();
        let common = &self.common;
        self.batch.each(&mut rows, |env, simulator, world, row| {
            common.play(env, simulator, world, row, &params);
        });
        self.common.step_counter += 1;
    }

    fn stat_names(&self) -> &'static [&'static str] {
        &STATS
    }

    fn stats(&mut self, out: &mut Array) {
        let out = out.host_mut();
        for (index, sum) in out.iter_mut().enumerate() {
            *sum = self
                .episodes
                .iter()
                .map(|episode| episode[SUMS + index])
                .sum();
        }
        for episode in &mut self.episodes {
            episode[SUMS..].fill(0.0);
        }
    }

    fn save(&self, to: &mut Section) -> Result<()> {
        let (envs, model) = (self.common.spec.envs, &self.common.batch.model);
        let max_contacts = self.common.batch.options.max_contacts;
        let mut episodes = vec![0.0; FIELDS * envs];
        let mut warm_start = vec![0; warm_start_dim(max_contacts, model.joints.len()) * envs];
        for (env, world) in self.batch.worlds.iter().enumerate() {
            scatter(&mut episodes, envs, env, 0, &self.episodes[env]);
            write_warm_start(&world.state, &mut warm_start, envs, env, max_contacts);
        }
        to.put("step_counter", self.common.step_counter);
        to.put_array("state", &self.batch.state()?);
        to.put_array("warm_start", &warm_start);
        to.put_array("episodes", &episodes);
        Ok(())
    }

    fn load(&mut self, from: &mut Section) -> Result<(), SectionError> {
        let (envs, model) = (self.common.spec.envs, self.common.batch.model.clone());
        let max_contacts = self.common.batch.options.max_contacts;
        let warm_start_dim = warm_start_dim(max_contacts, model.joints.len());
        let step_counter = from.get("step_counter")?;
        let state = from.take_finite("state", (model.nq() + model.nv()) * envs)?;
        let warm_start: Vec<u32> = from.take_array("warm_start", warm_start_dim * envs)?;
        let episodes = from.take_finite("episodes", FIELDS * envs)?;
        self.common.step_counter = step_counter;
        for (env, world) in self.batch.worlds.iter_mut().enumerate() {
            smooth_dynamics::read(&model, &state, envs, env, &mut world.state);
            read_warm_start(&warm_start, envs, env, max_contacts, &mut world.state);
            gather(&episodes, envs, env, 0, &mut self.episodes[env]);
        }
        self.observe_all();
        Ok(())
    }
}
