//! A task on all cores: each world plays its step from beginning to end while it is in the cache.

use super::common::Common;
use super::common::agent_bodies;
use super::humanoid_task::{HumanoidTask, StepContext, StepOutcome};
use crate::container::{Section, SectionError};
use crate::env::body_view::{BodyStates, BodyView, BodyWorlds};
use crate::env::humanoid::batch::{CpuSimulatorBatch, SimulatedWorld, SimulatorBatch};
use crate::env::live_view::LiveView;
use crate::env::spec::EnvSpec;
use crate::env::vec_env::{Transition, VecEnv};
use crate::gpu::Array;
use crate::kernels::humanoid::action_targets::set_targets;
use crate::kernels::humanoid::draw_starts::draw;
use crate::kernels::humanoid::end_episode::{self, LIMIT, end, fields, sums_at};
use crate::kernels::physics::proprioception;
use crate::kernels::physics::smooth_dynamics;
use crate::kernels::physics::solve_and_integrate::{
    read_warm_start, warm_start_dim, warm_start_room, write_warm_start,
};
use crate::kernels::physics::strided::{gather, scatter};
use crate::kernels::termination;
use crate::physics::simulator::Simulator;
use crate::physics::spatial::Spatial;
use anyhow::Result;
use glam::Vec2;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

/// Environments of a task on the CPU.
pub struct CpuHumanoidEnv {
    common: Common,
    /// The physics. External forces, a task's or somebody else's, last for a step.
    pub batch: CpuSimulatorBatch,
    /// Steps, return, measures and sums of each agent, `[rows][fields]`, see [`end_episode`].
    pub episodes: Vec<Vec<f32>>,
    /// What each environment carries for the task, `[envs][state_dim]`.
    pub task_states: Vec<Vec<f32>>,
    /// `[rows][observation]` of this moment.
    observation: Vec<f32>,
    /// Where to leave every step's state, if somebody watches.
    live_view: Option<Arc<Mutex<BodyStates>>>,
}

/// What a world reads and writes in a step: of each of its agents in turn, but for the state of the task.
struct WorldRows<'a> {
    action: &'a [f32],
    episodes: &'a mut [Vec<f32>],
    task_state: &'a mut [f32],
    reward: &'a mut [f32],
    termination: &'a mut [u32],
    group: &'a mut [u32],
    final_observation: &'a mut [f32],
    observation: &'a mut [f32],
}

/// Parameters of a step's kernels.
struct StepParams<'a> {
    now: StepContext,
    next: StepContext,
    end_episode: end_episode::Params,
    /// Pairs of bodies, one behind the other.
    force_pairs: &'a [u32],
}

impl CpuHumanoidEnv {
    /// Environments whose first episodes have their full length.
    pub fn unstaggered(
        task: Arc<dyn HumanoidTask>,
        envs: Range<usize>,
        seed: u32,
    ) -> CpuHumanoidEnv {
        let limits = vec![task.rules().steps() as f32; envs.len()];
        CpuHumanoidEnv::new(Common::new(task, envs, seed), &limits)
    }

    /// `limits`, `[envs]`, are the lengths of the first episodes in steps.
    pub(super) fn new(common: Common, limits: &[f32]) -> CpuHumanoidEnv {
        let mut batch = CpuSimulatorBatch::new(&common.batch);
        let mut task_states = vec![vec![0.0; common.task.state_dim()]; limits.len()];
        let moment = common.moment();
        for (env, (world, state)) in batch.worlds.iter_mut().zip(&mut task_states).enumerate() {
            common.begin(env, &moment, world, state);
        }
        let mut episodes = vec![vec![0.0; fields(common.measures)]; common.spec.rows()];
        for (row, episode) in episodes.iter_mut().enumerate() {
            episode[LIMIT] = limits[row / common.spec.agents];
        }
        let observation = vec![0.0; common.spec.rows() * common.spec.observation.dim()];
        let mut envs = CpuHumanoidEnv {
            common,
            batch,
            episodes,
            task_states,
            observation,
            live_view: None,
        };
        envs.observe_all();
        envs
    }

    /// The task.
    pub fn task(&self) -> &dyn HumanoidTask {
        &*self.common.task
    }

    /// What an agent observes now, `[observation]`.
    pub fn seen(&self, row: usize) -> &[f32] {
        let dim = self.common.spec.observation.dim();
        &self.observation[row * dim..][..dim]
    }

    /// Puts the target of an environment elsewhere on the ground, m: see [`HumanoidTask::move_target`].
    pub fn move_target(&mut self, env: usize, at: [f32; 2]) {
        let world = &mut self.batch.worlds[env].state;
        let state = &mut self.task_states[env];
        self.common.task.move_target(at, world, state);
        self.observe_all();
    }

    /// Says where somebody wants the body of an environment to move and to face: see [`HumanoidTask::steer`].
    pub fn steer(&mut self, env: usize, moving: Vec2, facing: Vec2) {
        let state = &mut self.task_states[env];
        self.common.task.steer(moving, facing, state);
    }

    /// Contacts that a saved state has room for: a GPU's, or as many as a world has.
    fn room(&self) -> usize {
        let worlds = self.batch.worlds.iter();
        let most = worlds.map(|world| world.state.contact_ids.len()).max();
        most.unwrap_or(0)
            .max(self.common.batch.options.max_contacts)
    }

    /// Observes the worlds anew, after somebody has changed them.
    pub fn observe_all(&mut self) {
        let common = &self.common;
        let rows = self
            .observation
            .chunks_exact_mut(common.world_observation());
        let mut rows: Vec<_> = rows.zip(&self.task_states).collect();
        self.batch
            .each(&mut rows, |_, simulator, world, (row, state)| {
                simulator.kinematics(&world.state.q, &world.state.v);
                common.observe(simulator, world, state, row);
            });
    }

    /// Leaves the state to whoever watches.
    fn show(&self) {
        if let Some(view) = &self.live_view {
            let worlds = self.batch.worlds.iter();
            let worlds = worlds.map(|world| (&world.state.q[..], &world.start[..]));
            let mut states = view.lock().unwrap_or_else(PoisonError::into_inner);
            states.set(worlds);
        }
    }
}

impl Common {
    /// Numbers that all agents of a world observe.
    fn world_observation(&self) -> usize {
        self.spec.agents * self.spec.observation.dim()
    }

    /// Begins an episode of a world.
    fn begin(
        &self,
        env: usize,
        moment: &StepContext,
        world: &mut SimulatedWorld,
        state: &mut [f32],
    ) {
        let start_states = self.task.start_states();
        draw(
            start_states,
            env,
            &mut world.start,
            &self.draw_starts(moment),
        );
        state.fill(0.0);
        self.task.begin(env, moment, &mut world.start, state);
        world.reset();
    }

    /// Observes a world whose kinematics the simulator has computed, for all its agents.
    fn observe(
        &self,
        simulator: &Simulator,
        world: &SimulatedWorld,
        state: &[f32],
        out: &mut [f32],
    ) {
        let characters = self.characters[1..].chunks_exact(1 + self.characters[0] as usize);
        let rows = out.chunks_exact_mut(self.spec.observation.dim());
        for (agent, (character, row)) in characters.zip(rows).enumerate() {
            proprioception::observe(
                &simulator.model,
                &world.state.q,
                &world.state.v,
                &simulator.poses,
                &simulator.velocities,
                character,
                row,
            );
            let row = &mut row[self.body_dim()..];
            self.task.observe(agent, simulator, world, state, row);
        }
    }

    /// Plays one step of a world.
    fn play(
        &self,
        env: usize,
        simulator: &mut Simulator,
        world: &mut SimulatedWorld,
        rows: &mut WorldRows,
        params: &StepParams,
    ) {
        set_targets(rows.action, &self.action_scale, &mut world.targets);
        self.task.act(env, &params.now, world);
        world.advance(simulator, params.force_pairs);
        world.external_forces.fill(Spatial::ZERO);
        simulator.kinematics(&world.state.q, &world.state.v);
        self.end_step(simulator, world, rows, params);
        if rows.termination[0] != termination::RUNNING {
            self.observe(simulator, world, rows.task_state, rows.final_observation);
            self.begin(env, &params.next, world, rows.task_state);
            simulator.kinematics(&world.state.q, &world.state.v);
        }
        self.observe(simulator, world, rows.task_state, rows.observation);
    }

    /// What the step of a world comes to for its agents, and how it ends.
    fn end_step(
        &self,
        simulator: &Simulator,
        world: &SimulatedWorld,
        rows: &mut WorldRows,
        params: &StepParams,
    ) {
        let mut outcomes = vec![StepOutcome::default(); self.spec.agents];
        let mut measures = vec![0.0; self.spec.agents * self.measures];
        self.task.reward(
            &params.now,
            simulator,
            world,
            rows.task_state,
            &mut outcomes,
            &mut measures,
        );
        for (agent, outcome) in outcomes.iter().enumerate() {
            let step = end_episode::EpisodeStep {
                q: &world.state.q,
                v: &world.state.v,
                poses: &simulator.poses[agent * agent_bodies(&simulator.model)..],
                measures: &measures[agent * self.measures..][..self.measures],
                task_end: outcome.end,
            };
            let (reward, episode) = (&mut rows.reward[agent], &mut rows.episodes[agent]);
            *reward = outcome.reward;
            rows.group[agent] = outcome.group;
            rows.termination[agent] = end(&step, reward, episode, &params.end_episode);
        }
    }
}

impl VecEnv for CpuHumanoidEnv {
    fn spec(&self) -> &EnvSpec {
        &self.common.spec
    }

    fn rest_action(&self) -> Vec<f32> {
        self.common.task.rest_action()
    }

    fn observe(&mut self, out: &mut Array, at: usize) {
        out.host_mut()[at..][..self.observation.len()].copy_from_slice(&self.observation);
    }

    fn step(&mut self, action: &Array, at: usize, out: Transition) {
        let (spec, now) = (self.common.spec, self.common.moment());
        let (agents, dim) = (spec.agents, self.common.world_observation());
        let first = out.step * spec.rows();
        let force_pairs = self.common.batch.force_pairs();
        let params = StepParams {
            next: StepContext {
                step_counter: now.step_counter + 1,
                ..now
            },
            now,
            end_episode: self.common.end_episode(0),
            force_pairs: &force_pairs[1..],
        };
        let actions = action.host()[at..].chunks_exact(agents * spec.action);
        let rewards = out.reward.host_mut()[first..].chunks_exact_mut(agents);
        let terminations = out.termination.host_mut()[first..].chunks_exact_mut(agents);
        let groups = out.group.host_mut()[first..].chunks_exact_mut(agents);
        let final_at = spec.final_row(out.step) * spec.observation.dim();
        let finals = out.final_observation.host_mut()[final_at..].chunks_exact_mut(dim);
        let observations = self.observation.chunks_exact_mut(dim);
        let episodes = self.episodes.chunks_exact_mut(agents);
        let rows = actions.zip(episodes).zip(&mut self.task_states);
        let rows = rows.zip(rewards).zip(terminations.zip(groups));
        let rows = rows.zip(finals.zip(observations));
        let mut rows: Vec<WorldRows> = rows
            .map(
                |(
                    ((((action, episodes), task_state), reward), (termination, group)),
                    (last, observation),
                )| WorldRows {
                    action,
                    episodes,
                    task_state,
                    reward,
                    termination,
                    group,
                    final_observation: last,
                    observation,
                },
            )
            .collect();
        let common = &self.common;
        self.batch.each(&mut rows, |env, simulator, world, rows| {
            common.play(env, simulator, world, rows, &params);
        });
        self.common.step_counter += 1;
        self.show();
    }

    fn stat_names(&self) -> &'static [&'static str] {
        self.common.task.stat_names()
    }

    fn stats(&mut self, out: &mut Array) {
        let sums = sums_at(self.common.measures);
        for (index, sum) in out.host_mut().iter_mut().enumerate() {
            *sum = self
                .episodes
                .iter()
                .map(|episode| episode[sums + index])
                .sum();
        }
        for episode in &mut self.episodes {
            episode[sums..].fill(0.0);
        }
    }

    fn row_stats(&self) -> Option<Array> {
        let (sums, rows) = (sums_at(self.common.measures), self.episodes.len());
        let mut stats = vec![0.0; self.stat_names().len() * rows];
        for (row, episode) in self.episodes.iter().enumerate() {
            scatter(&mut stats, rows, row, 0, &episode[sums..]);
        }
        Some(Array::Host(stats))
    }

    fn restart(&mut self, which: &[bool]) -> Result<()> {
        self.common.step_counter += 1;
        let (common, moment) = (&self.common, self.common.moment());
        let episodes = self.episodes.chunks_exact_mut(common.spec.agents);
        let worlds = self.batch.worlds.iter_mut().zip(&mut self.task_states);
        for (env, ((world, state), episodes)) in worlds.zip(episodes).enumerate() {
            if which[env] {
                common.begin(env, &moment, world, state);
                for episode in episodes {
                    end_episode::begin(episode, &common.end_episode(0));
                }
            }
        }
        self.observe_all();
        Ok(())
    }

    fn live_view(&mut self) -> Result<Option<LiveView>> {
        let states = Arc::new(Mutex::new(BodyStates::default()));
        self.live_view = Some(states.clone());
        self.show();
        Ok(Some(LiveView::Bodies(BodyView {
            model: self.common.batch.model.clone(),
            worlds: BodyWorlds::Cpu(vec![states]),
        })))
    }

    fn contact_overflow(&self) -> Result<u64> {
        Ok(self.batch.counters()?.overflow)
    }

    fn save(&self, to: &mut Section) -> Result<()> {
        let (envs, model) = (self.common.spec.envs, &self.common.batch.model);
        let (room, rows) = (self.room(), self.common.spec.rows());
        let mut episodes = vec![0.0; fields(self.common.measures) * rows];
        let mut task_states = vec![0.0; self.common.task.state_dim() * envs];
        let mut warm_start = vec![0; warm_start_dim(room, model.joints.len()) * envs];
        for (env, world) in self.batch.worlds.iter().enumerate() {
            scatter(&mut task_states, envs, env, 0, &self.task_states[env]);
            write_warm_start(&world.state, &mut warm_start, envs, env, room);
        }
        for (row, episode) in self.episodes.iter().enumerate() {
            scatter(&mut episodes, rows, row, 0, episode);
        }
        to.put("step_counter", self.common.step_counter);
        to.put_array("state", &self.batch.state()?);
        to.put_array("warm_start", &warm_start);
        to.put_array("episodes", &episodes);
        to.put_array("task_state", &task_states);
        Ok(())
    }

    fn load(&mut self, from: &mut Section) -> Result<(), SectionError> {
        let (envs, model) = (self.common.spec.envs, self.common.batch.model.clone());
        let (joints, rows) = (model.joints.len(), self.common.spec.rows());
        let room = warm_start_room(from.array_len("warm_start") / envs, joints);
        let step_counter = from.get("step_counter")?;
        let state = from.take_finite("state", (model.nq() + model.nv()) * envs)?;
        let warm_start: Vec<u32> =
            from.take_array("warm_start", warm_start_dim(room, joints) * envs)?;
        let episodes = from.take_finite("episodes", fields(self.common.measures) * rows)?;
        let task_states = self.common.task.state_dim() * envs;
        let task_states = from.take_finite("task_state", task_states)?;
        self.common.step_counter = step_counter;
        for (env, world) in self.batch.worlds.iter_mut().enumerate() {
            smooth_dynamics::read(&model, &state, envs, env, &mut world.state);
            read_warm_start(&warm_start, envs, env, room, &mut world.state);
            gather(&task_states, envs, env, 0, &mut self.task_states[env]);
        }
        for (row, episode) in self.episodes.iter_mut().enumerate() {
            gather(&episodes, rows, row, 0, episode);
        }
        self.observe_all();
        Ok(())
    }
}
