//! Environments on the CPU: the twins, with the pruned search in place of the plain one.

use super::config::{EnvConfig, STAT_NAMES};
use super::env_state::EnvState;
use super::env_state::gather;
use super::kernel_params::KernelParams;
use crate::container::{Section, SectionError};
use crate::env::live_view::{LiveView, LocomotionView, State, States};
use crate::env::spec::EnvSpec;
use crate::env::vec_env::{Transition, VecEnv};
use crate::gpu::Array;
use crate::kernels::locomotion::locomotion_layout::{
    MAP_WORDS, VELOCITY_DIM, boxes, state_f32, state_u32,
};
use crate::kernels::locomotion::obstacles::inside;
use crate::kernels::locomotion::{
    advance_and_reward, build_query, episode_stats, hits, move_obstacles, observe,
    obstacle_collision, rasterize_maps, reset, spawn_obstacles,
};
use crate::kernels::termination::restarted;
use crate::matching::MotionMatcher;
use crate::motion::features::{ROW_STRIDE, TRAJECTORY_DIM};
use std::sync::{Arc, Mutex, PoisonError};

/// A batch of locomotion environments on the CPU.
#[derive(Clone)]
pub struct CpuLocomotion {
    matcher: Arc<MotionMatcher>,
    spec: EnvSpec,
    /// What the kernels' parameters depend on: the task, the level, the steps so far.
    pub params: KernelParams,
    /// `[2][TRAJECTORY_DIM]`: mean and scale of the trajectory features.
    normal: Vec<f32>,
    /// `[state_f32::FIELDS][envs]`, see [`crate::kernels::locomotion::locomotion_layout`].
    pub state_f32: Vec<f32>,
    /// `[state_u32::FIELDS][envs]`
    pub state_u32: Vec<u32>,
    /// `[envs][boxes::FIELDS][count]`
    pub boxes: Vec<f32>,
    /// `[envs][VELOCITY_DIM][count]`
    pub obstacle_velocity: Vec<f32>,
    /// `[envs][MAP_WORDS]`
    pub maps: Vec<u32>,
    /// `[envs]`, the queries of the last step.
    pub queries: Vec<[f32; ROW_STRIDE]>,
    /// `[envs]`, the candidates that the last step found.
    pub matched: Vec<u32>,
    /// `[envs]`, of the last step.
    pub reward: Vec<f32>,
    /// `[envs]`, how the last step ended.
    pub termination: Vec<u32>,
    /// Where to leave every step's state, if somebody watches.
    live_view: Option<Arc<Mutex<State>>>,
}

impl CpuLocomotion {
    /// Environments at the start of an episode.
    pub fn new(matcher: Arc<MotionMatcher>, config: &EnvConfig) -> Self {
        Self::part(matcher, config, 0, 0)
    }

    /// Environments of a larger batch, the first of which has the number `first` there; the limits of
    /// their first episodes are up to `initial_age_jitter` steps early.
    pub fn part(
        matcher: Arc<MotionMatcher>,
        config: &EnvConfig,
        first: usize,
        initial_age_jitter: u32,
    ) -> Self {
        let (envs, count) = (config.envs, config.task.obstacles());
        let mut part = CpuLocomotion {
            spec: config.spec(),
            params: KernelParams::new(config, first, matcher.database.candidates.len()),
            normal: matcher.database.normalisation.trajectory(),
            state_f32: vec![0.0; state_f32::FIELDS * envs],
            state_u32: vec![0; state_u32::FIELDS * envs],
            boxes: vec![0.0; envs * boxes::FIELDS * count],
            obstacle_velocity: vec![0.0; envs * VELOCITY_DIM * count],
            maps: vec![0; envs * MAP_WORDS],
            queries: vec![[0.0; ROW_STRIDE]; envs],
            matched: vec![0; envs],
            reward: vec![0.0; envs],
            termination: vec![0; envs],
            live_view: None,
            matcher,
        };
        part.reset(true, initial_age_jitter);
        part
    }

    /// Starts new episodes, in `all` environments or where this step ended one.
    fn reset(&mut self, all: bool, initial_age_jitter: u32) {
        let obstacles = self.params.task.obstacles() > 0;
        if obstacles {
            let params = self.params.spawn_obstacles(all);
            spawn_obstacles::twin(
                &self.termination,
                &mut self.boxes,
                &mut self.obstacle_velocity,
                &params,
            );
        }
        reset::twin(
            &self.matcher.database.candidates,
            &self.termination,
            &self.boxes,
            &mut self.state_f32,
            &mut self.state_u32,
            &self.params.reset(all, initial_age_jitter),
        );
        if obstacles {
            self.rasterize_maps(true);
        }
    }

    fn rasterize_maps(&mut self, just_reset: bool) {
        let params = self.params.rasterize_maps(just_reset);
        rasterize_maps::twin(
            &self.boxes,
            &self.obstacle_velocity,
            &self.state_f32,
            &self.state_u32,
            &mut self.maps,
            &params,
        );
    }

    /// Observations `[envs][observation]` of all environments.
    pub fn observation(&self) -> Vec<f32> {
        let mut observation = vec![0.0; self.params.envs * self.params.observation_dim()];
        self.write_observation(&mut observation, &self.params.observe(0));
        observation
    }

    fn write_observation(&self, observation: &mut [f32], params: &observe::Params) {
        observe::twin(
            &self.matcher.database.features,
            &self.state_f32,
            &self.state_u32,
            &self.termination,
            &self.maps,
            observation,
            params,
        );
    }

    /// Plays one step without resetting what it ended. `action` is `[envs][TRAJECTORY_DIM]`.
    pub fn step_without_reset(&mut self, action: &[f32]) {
        self.build_queries(action);
        self.search();
        self.play_matches();
    }

    /// Begins a step: `action` is `[envs][TRAJECTORY_DIM]`.
    pub fn build_queries(&mut self, action: &[f32]) {
        let obstacles = self.params.task.obstacles() > 0;
        if obstacles {
            hits::twin(
                action,
                &self.normal,
                &self.boxes,
                &self.state_f32,
                &mut self.state_u32,
                &self.params.hits(0),
            );
        }
        build_query::twin(
            &self.matcher.database.features,
            &self.state_u32,
            action,
            &mut self.queries,
            &self.params.build_query(0),
        );
    }

    /// Finds the candidates nearest to the queries.
    pub fn search(&mut self) {
        let frames = &self.state_u32[state_u32::FRAME * self.params.envs..][..self.params.envs];
        self.matcher
            .nearest_all(frames, &self.queries, &mut self.matched);
    }

    /// Plays a step to its end with the candidates that were found.
    pub fn play_matches(&mut self) {
        let obstacles = self.params.task.obstacles() > 0;
        if obstacles {
            obstacle_collision::twin(
                &self.matcher.database.candidates,
                &self.matched,
                &self.matcher.database.path,
                &self.boxes,
                &self.obstacle_velocity,
                &self.state_f32,
                &mut self.state_u32,
                &self.params.obstacle_collision(),
            );
            move_obstacles::twin(
                &mut self.boxes,
                &mut self.obstacle_velocity,
                &self.params.move_obstacles(),
            );
        }
        advance_and_reward::twin(
            &self.matcher.database.candidates,
            &self.matched,
            &self.matcher.database.motion,
            &mut self.state_f32,
            &mut self.state_u32,
            &mut self.reward,
            &mut self.termination,
            &self.params.advance_and_reward(),
        );
        if obstacles {
            self.rasterize_maps(false);
        }
    }

    /// Goes on with the same motion in another place, where there may be more of it.
    pub fn set_matcher(&mut self, matcher: &Arc<MotionMatcher>) {
        self.matcher = matcher.clone();
        self.params.candidates = matcher.database.candidates.len();
    }

    /// One number of the floating-point state.
    pub fn field(&self, field: usize, env: usize) -> f32 {
        self.state_f32[field * self.params.envs + env]
    }

    /// Puts an environment's target elsewhere on the ground, `[x, z]`, m.
    pub fn set_target(&mut self, env: usize, at: [f32; 2]) {
        for (field, value) in [state_f32::TARGET_X, state_f32::TARGET_Z]
            .into_iter()
            .zip(at)
        {
            self.state_f32[field * self.params.envs + env] = value;
        }
    }

    /// An obstacle of an environment: centre and half sides, m.
    pub fn obstacle(&self, env: usize, slot: usize) -> [f32; boxes::FIELDS] {
        let count = self.params.task.obstacles();
        std::array::from_fn(|field| self.boxes[(env * boxes::FIELDS + field) * count + slot])
    }

    /// Whether a point lies in an obstacle of an environment.
    pub fn blocked(&self, env: usize, point: [f32; 2]) -> bool {
        (0..self.params.task.obstacles()).any(|slot| {
            let [x, z, half_x, half_z] = self.obstacle(env, slot);
            inside(point, [x, z], [half_x, half_z])
        })
    }

    /// Draws the present maps anew after somebody has moved obstacles.
    pub fn refresh_maps(&mut self) {
        let before = self.maps.clone();
        self.rasterize_maps(true);
        self.rasterize_maps(false);
        let seen = self.maps.chunks_exact_mut(MAP_WORDS);
        for (maps, before) in seen.zip(before.chunks_exact(MAP_WORDS)) {
            maps[MAP_WORDS / 2..].copy_from_slice(&before[MAP_WORDS / 2..]);
        }
    }

    /// Goes on with these environments alone; one may be named several times.
    pub fn retain(&mut self, envs: &[usize]) {
        let (old, count) = (self.params.envs, self.params.task.obstacles());
        self.state_f32 = gather(&self.state_f32, old, 1, envs);
        self.state_u32 = gather(&self.state_u32, old, 1, envs);
        self.boxes = gather(&self.boxes, old, boxes::FIELDS * count, envs);
        self.obstacle_velocity = gather(&self.obstacle_velocity, old, VELOCITY_DIM * count, envs);
        self.maps = gather(&self.maps, old, MAP_WORDS, envs);
        self.reward = gather(&self.reward, old, 1, envs);
        self.termination = gather(&self.termination, old, 1, envs);
        self.queries.resize(envs.len(), [0.0; ROW_STRIDE]);
        self.matched.resize(envs.len(), 0);
        self.params.envs = envs.len();
        self.spec.envs = envs.len();
    }
}

impl VecEnv for CpuLocomotion {
    fn spec(&self) -> &EnvSpec {
        &self.spec
    }

    fn observe(&mut self, out: &mut Array, at: usize) {
        let rows = at / self.params.observation_dim();
        self.write_observation(out.host_mut(), &self.params.observe(rows));
    }

    fn step(&mut self, action: &Array, at: usize, out: Transition) {
        let envs = self.params.envs;
        self.step_without_reset(&action.host()[at..][..envs * TRAJECTORY_DIM]);
        out.reward.host_mut()[out.step * envs..][..envs].copy_from_slice(&self.reward);
        out.termination.host_mut()[out.step * envs..][..envs].copy_from_slice(&self.termination);
        let row = self.spec.final_row(out.step);
        let params = self.params.observe_final(row);
        self.write_observation(out.final_observation.host_mut(), &params);
        self.reset(false, 0);
        self.params.step_counter += 1;
        if let Some(view) = &self.live_view {
            let mut state = view.lock().unwrap_or_else(PoisonError::into_inner);
            state.set(&self.state_f32, &self.state_u32, &self.boxes);
        }
    }

    fn stat_names(&self) -> &'static [&'static str] {
        &STAT_NAMES
    }

    fn stats(&mut self, out: &mut Array) {
        let params = self.params.episode_stats();
        episode_stats::twin(
            &mut self.state_f32,
            &mut self.state_u32,
            out.host_mut(),
            &params,
        );
    }

    fn row_stats(&self) -> Option<Array> {
        let rows = episode_stats::rows(&self.state_f32, &self.state_u32, self.params.envs);
        Some(Array::Host(rows))
    }

    fn restart(&mut self, which: &[bool]) -> anyhow::Result<()> {
        self.termination = restarted(which);
        self.reset(false, 0);
        self.params.step_counter += 1;
        Ok(())
    }

    fn set_level(&mut self, level: u32) {
        self.params.level = level;
    }

    fn live_view(&mut self) -> anyhow::Result<Option<LiveView>> {
        let mut state = State::default();
        state.set(&self.state_f32, &self.state_u32, &self.boxes);
        let state = Arc::new(Mutex::new(state));
        self.live_view = Some(state.clone());
        let view = LocomotionView::Cpu(States(vec![state]));
        Ok(Some(LiveView::Locomotion(view)))
    }

    fn save(&self, to: &mut Section) -> anyhow::Result<()> {
        EnvState {
            step_counter: self.params.step_counter,
            level: self.params.level,
            state_f32: self.state_f32.clone(),
            state_u32: self.state_u32.clone(),
            boxes: self.boxes.clone(),
            obstacle_velocity: self.obstacle_velocity.clone(),
            maps: self.maps.clone(),
        }
        .save(to);
        Ok(())
    }

    fn load(&mut self, from: &mut Section) -> Result<(), SectionError> {
        let (envs, count) = (self.params.envs, self.params.task.obstacles());
        let state = EnvState::load(from, envs, count, self.matcher.database.frames())?;
        (self.params.step_counter, self.params.level) = (state.step_counter, state.level);
        self.state_f32 = state.state_f32;
        self.state_u32 = state.state_u32;
        self.boxes = state.boxes;
        self.obstacle_velocity = state.obstacle_velocity;
        self.maps = state.maps;
        Ok(())
    }
}
