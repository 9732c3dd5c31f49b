//! Worlds on the CPU: the twins, with the pruned search in place of the plain one.

use super::kernel_params::KernelParams;
use super::env_state::gather;
use super::live_view::{State, States, LiveView};
use super::{Setup, EnvState, Values, World};
use crate::kernels::locomotion::locomotion_layout::{VELOCITY_DIM, MAP_WORDS, boxes, state_f32, state_u32};
use crate::kernels::locomotion::obstacles::inside;
use crate::kernels::learn::{sample_action, gae};
use crate::kernels::locomotion::{obstacle_collision, hits, observe, build_query, reset, spawn_obstacles, rasterize_maps, advance_and_reward, episode_stats, move_obstacles};
use crate::motion::database::{Database, ROW_STRIDE};
use crate::motion::features::TRAJECTORY_DIM;
use crate::matching::Index;
use crate::nn::tensors::{upload, values};
use burn::tensor::{Device, Tensor};
use std::sync::{Arc, Mutex, PoisonError};

#[derive(Clone)]
pub struct CpuLocomotion {
    database: Arc<Database>,
    index: Arc<Index>,
    pub rules: KernelParams,
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
    /// `[envs]`, what the last step asked.
    pub queries: Vec<[f32; ROW_STRIDE]>,
    /// `[envs]`, the candidates that the last step found.
    pub matched: Vec<u32>,
    /// `[horizon][envs]`
    reward: Vec<f32>,
    /// `[horizon][envs]`, how each step ended.
    pub termination: Vec<u32>,
    /// `[final_steps][envs][width]`
    last: Vec<f32>,
    device: Device,
    /// Where to leave every step's state, if somebody watches.
    watched: Option<Arc<Mutex<State>>>,
}

impl CpuLocomotion {
    /// Worlds at the start of an episode; the limits of these first episodes are up to `spread`
    /// early.
    pub fn new(database: Arc<Database>, setup: &Setup, initial_age_jitter: u32) -> Self {
        Self::part(database, setup, 0, initial_age_jitter)
    }

    /// The same, of a larger batch: the first of these worlds is its number `first`.
    pub fn part(database: Arc<Database>, setup: &Setup, first: usize, initial_age_jitter: u32) -> Self {
        let envs = setup.envs;
        let rules = KernelParams {
            first,
            ..setup.rules(&database)
        };
        let count = setup.task.obstacles();
        let mut world = CpuLocomotion {
            index: database.index(),
            normal: database.normalisation.trajectory(),
            state_f32: vec![0.0; state_f32::FIELDS * envs],
            state_u32: vec![0; state_u32::FIELDS * envs],
            boxes: vec![0.0; envs * boxes::FIELDS * count],
            obstacle_velocity: vec![0.0; envs * VELOCITY_DIM * count],
            maps: vec![0; envs * MAP_WORDS],
            queries: vec![[0.0; ROW_STRIDE]; envs],
            matched: vec![0; envs],
            reward: vec![0.0; setup.horizon * envs],
            termination: vec![0; setup.horizon * envs],
            last: vec![0.0; rules.final_steps() * envs * setup.task.width()],
            device: Device::flex(),
            watched: None,
            rules,
            database,
        };
        world.begin(true, initial_age_jitter);
        world
    }

    /// Starts new episodes, `everywhere` or where this step ended one.
    fn begin(&mut self, all: bool, initial_age_jitter: u32) {
        let obstacles = self.rules.task.obstacles() > 0;
        if obstacles {
            let params = self.rules.scatter(all);
            spawn_obstacles::twin(&self.termination, &mut self.boxes, &mut self.obstacle_velocity, &params);
        }
        reset::twin(
            &self.database.candidates,
            &self.termination,
            &self.boxes,
            &mut self.state_f32,
            &mut self.state_u32,
            &self.rules.reset(all, initial_age_jitter),
        );
        if obstacles {
            self.sense(true);
        }
    }

    fn sense(&mut self, just_reset: bool) {
        let params = self.rules.sense(just_reset);
        rasterize_maps::twin(
            &self.boxes,
            &self.obstacle_velocity,
            &self.state_f32,
            &self.state_u32,
            &mut self.maps,
            &params,
        );
    }

    /// Observations `[envs][width]` of all environments.
    pub fn observation(&self) -> Vec<f32> {
        let mut observation = vec![0.0; self.rules.envs * self.rules.task.width()];
        self.see(&mut observation, &self.rules.observe());
        observation
    }

    fn see(&self, observation: &mut [f32], params: &observe::Params) {
        observe::twin(
            &self.database.features,
            &self.state_f32,
            &self.state_u32,
            &self.termination,
            &self.maps,
            observation,
            params,
        );
    }

    /// Plays one step without starting anew what it ended. `action` is `[envs][TRAJECTORY_DIM]`.
    pub fn play(&mut self, action: &[f32]) {
        let obstacles = self.rules.task.obstacles() > 0;
        if obstacles {
            hits::twin(
                action,
                &self.normal,
                &self.boxes,
                &self.state_f32,
                &mut self.state_u32,
                &self.rules.hits(),
            );
        }
        build_query::twin(
            &self.database.features,
            &self.state_u32,
            action,
            &mut self.queries,
            &self.rules.query(),
        );
        let frames = &self.state_u32[state_u32::FRAME * self.rules.envs..][..self.rules.envs];
        self.index
            .nearest_all(frames, &self.queries, &mut self.matched);
        if obstacles {
            obstacle_collision::twin(
                &self.database.candidates,
                &self.matched,
                &self.database.path,
                &self.boxes,
                &self.obstacle_velocity,
                &self.state_f32,
                &mut self.state_u32,
                &self.rules.collide(),
            );
            move_obstacles::twin(&mut self.boxes, &mut self.obstacle_velocity, &self.rules.wander());
        }
        advance_and_reward::twin(
            &self.database.candidates,
            &self.matched,
            &self.database.motion,
            &mut self.state_f32,
            &mut self.state_u32,
            &mut self.reward,
            &mut self.termination,
            &self.rules.step(),
        );
        if obstacles {
            self.sense(false);
        }
    }

    /// One number of the floating-point state.
    pub fn field(&self, field: usize, env: usize) -> f32 {
        self.state_f32[field * self.rules.envs + env]
    }

    /// An obstacle of an environment: centre and half sides, m.
    pub fn obstacle(&self, env: usize, slot: usize) -> [f32; boxes::FIELDS] {
        let count = self.rules.task.obstacles();
        std::array::from_fn(|field| self.boxes[(env * boxes::FIELDS + field) * count + slot])
    }

    /// Whether a point lies in an obstacle of an environment.
    pub fn blocked(&self, env: usize, point: [f32; 2]) -> bool {
        (0..self.rules.task.obstacles()).any(|slot| {
            let [x, z, half_x, half_z] = self.obstacle(env, slot);
            inside(point, [x, z], [half_x, half_z])
        })
    }

    /// Brings what is seen now up to date with obstacles that somebody has moved.
    pub fn look_again(&mut self) {
        let before = self.maps.clone();
        self.sense(true);
        self.sense(false);
        let seen = self.maps.chunks_exact_mut(MAP_WORDS);
        for (maps, before) in seen.zip(before.chunks_exact(MAP_WORDS)) {
            maps[MAP_WORDS / 2..].copy_from_slice(&before[MAP_WORDS / 2..]);
        }
    }

    /// Goes on with these environments alone; one may be named several times.
    pub fn keep(&mut self, envs: &[usize]) {
        let (old, count) = (self.rules.envs, self.rules.task.obstacles());
        self.state_f32 = gather(&self.state_f32, old, 1, envs);
        self.state_u32 = gather(&self.state_u32, old, 1, envs);
        self.boxes = gather(&self.boxes, old, boxes::FIELDS * count, envs);
        self.obstacle_velocity = gather(&self.obstacle_velocity, old, VELOCITY_DIM * count, envs);
        self.maps = gather(&self.maps, old, MAP_WORDS, envs);
        self.reward = gather(&self.reward, old, 1, envs);
        self.termination = gather(&self.termination, old, 1, envs);
        self.queries.resize(envs.len(), [0.0; ROW_STRIDE]);
        self.matched.resize(envs.len(), 0);
        self.rules.envs = envs.len();
    }

    fn tensor<const D: usize>(&self, values: Vec<f32>, shape: [usize; D]) -> Tensor<D> {
        upload(values, shape, &self.device)
    }
}

impl World for CpuLocomotion {
    fn observe(&mut self) -> Tensor<2> {
        let shape = [self.rules.envs, self.rules.task.width()];
        self.tensor(self.observation(), shape)
    }

    fn act(&mut self, mean: Tensor<2>, log_std: Tensor<1>) -> (Tensor<2>, Tensor<1>) {
        let envs = self.rules.envs;
        let (mut action, mut log_prob) = (vec![0.0; envs * TRAJECTORY_DIM], vec![0.0; envs]);
        sample_action::twin(
            &values(mean),
            &values(log_std),
            &mut action,
            &mut log_prob,
            &self.rules.act(),
        );
        (
            self.tensor(action, [envs, TRAJECTORY_DIM]),
            self.tensor(log_prob, [envs]),
        )
    }

    fn step(&mut self, action: Tensor<2>) {
        self.play(&values(action));
        let mut last = std::mem::take(&mut self.last);
        self.see(&mut last, &self.rules.observe_last());
        self.last = last;
        self.begin(false, 0);
        self.rules.step_counter += 1;
        if let Some(watched) = &self.watched {
            let mut state = watched.lock().unwrap_or_else(PoisonError::into_inner);
            state.set(&self.state_f32, &self.state_u32, &self.boxes);
        }
    }

    fn last(&mut self) -> Tensor<2> {
        let width = self.rules.task.width();
        self.tensor(self.last.clone(), [self.last.len() / width, width])
    }

    fn judge(&mut self, judged: Values, gamma: f32, lambda: f32) -> (Tensor<1>, Tensor<1>) {
        let samples = self.reward.len();
        let (mut advantage, mut target) = (vec![0.0; samples], vec![0.0; samples]);
        gae::twin(
            &self.reward,
            &self.termination,
            &values(judged.observed),
            &values(judged.next),
            &values(judged.last),
            &values(judged.scale),
            &mut advantage,
            &mut target,
            &self.rules.gae(gamma, lambda),
        );
        (
            self.tensor(advantage, [samples]),
            self.tensor(target, [samples]),
        )
    }

    fn tally(&mut self) -> Tensor<1> {
        let mut sums = [0.0; episode_stats::SUMS];
        let params = self.rules.tally();
        episode_stats::twin(&mut self.state_f32, &mut self.state_u32, &mut sums, &params);
        self.tensor(sums.to_vec(), [episode_stats::SUMS])
    }

    fn set_level(&mut self, level: u32) {
        self.rules.level = level;
    }

    fn snapshot(&self) -> anyhow::Result<EnvState> {
        Ok(EnvState {
            step_counter: self.rules.step_counter,
            level: self.rules.level,
            state_f32: self.state_f32.clone(),
            state_u32: self.state_u32.clone(),
            boxes: self.boxes.clone(),
            obstacle_velocity: self.obstacle_velocity.clone(),
            maps: self.maps.clone(),
        })
    }

    fn watch(&mut self) -> anyhow::Result<LiveView> {
        let mut state = State::default();
        state.set(&self.state_f32, &self.state_u32, &self.boxes);
        let state = Arc::new(Mutex::new(state));
        self.watched = Some(state.clone());
        Ok(LiveView::Cpu(States(vec![state])))
    }

    fn restore(&mut self, snapshot: &EnvState) {
        (self.rules.step_counter, self.rules.level) = (snapshot.step_counter, snapshot.level);
        self.state_f32.clone_from(&snapshot.state_f32);
        self.state_u32.clone_from(&snapshot.state_u32);
        self.boxes.clone_from(&snapshot.boxes);
        self.obstacle_velocity.clone_from(&snapshot.obstacle_velocity);
        self.maps.clone_from(&snapshot.maps);
    }
}
