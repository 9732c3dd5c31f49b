//! Worlds on the CPU: the twins, with the pruned search in place of the plain one.

use super::rules::Rules;
use super::snapshot::gather;
use super::watched::{State, States, Watched};
use super::{Setup, Snapshot, Values, World};
use crate::kernels::layout::{AXES, MAP_WORDS, boxes, real, whole};
use crate::kernels::obstacles::inside;
use crate::kernels::{
    act, collide, gae, hits, observe, query, reset, scatter, sense, step, tally, wander,
};
use crate::motion::database::{Database, PADDED};
use crate::motion::features::TRAJECTORY;
use crate::search::Index;
use crate::tensors::{upload, values};
use burn::tensor::{Device, Tensor};
use std::sync::{Arc, Mutex, PoisonError};

#[derive(Clone)]
pub struct CpuWorld {
    database: Arc<Database>,
    index: Arc<Index>,
    pub rules: Rules,
    /// `[2][TRAJECTORY]`: mean and scale of the trajectory features.
    normal: Vec<f32>,
    /// `[real::FIELDS][envs]`, see [`crate::kernels::layout`].
    pub real: Vec<f32>,
    /// `[whole::FIELDS][envs]`
    pub whole: Vec<u32>,
    /// `[envs][boxes::FIELDS][count]`
    pub boxes: Vec<f32>,
    /// `[envs][AXES][count]`
    pub drift: Vec<f32>,
    /// `[envs][MAP_WORDS]`
    pub maps: Vec<u32>,
    /// `[envs]`, what the last step asked.
    pub queries: Vec<[f32; PADDED]>,
    /// `[envs]`, the candidates that the last step found.
    pub matched: Vec<u32>,
    /// `[horizon][envs]`
    reward: Vec<f32>,
    /// `[horizon][envs]`, how each step ended.
    pub ended: Vec<u32>,
    /// `[final_steps][envs][width]`
    last: Vec<f32>,
    device: Device,
    /// Where to leave every step's state, if somebody watches.
    watched: Option<Arc<Mutex<State>>>,
}

impl CpuWorld {
    /// Worlds at the start of an episode; the limits of these first episodes are up to `spread`
    /// early.
    pub fn new(database: Arc<Database>, setup: &Setup, spread: u32) -> Self {
        Self::part(database, setup, 0, spread)
    }

    /// The same, of a larger batch: the first of these worlds is its number `first`.
    pub fn part(database: Arc<Database>, setup: &Setup, first: usize, spread: u32) -> Self {
        let envs = setup.envs;
        let rules = Rules {
            first,
            ..setup.rules(&database)
        };
        let count = setup.task.obstacles();
        let mut world = CpuWorld {
            index: database.index(),
            normal: database.normalisation.trajectory(),
            real: vec![0.0; real::FIELDS * envs],
            whole: vec![0; whole::FIELDS * envs],
            boxes: vec![0.0; envs * boxes::FIELDS * count],
            drift: vec![0.0; envs * AXES * count],
            maps: vec![0; envs * MAP_WORDS],
            queries: vec![[0.0; PADDED]; envs],
            matched: vec![0; envs],
            reward: vec![0.0; setup.horizon * envs],
            ended: vec![0; setup.horizon * envs],
            last: vec![0.0; rules.final_steps() * envs * setup.task.width()],
            device: Device::flex(),
            watched: None,
            rules,
            database,
        };
        world.begin(true, spread);
        world
    }

    /// Starts new episodes, `everywhere` or where this step ended one.
    fn begin(&mut self, everywhere: bool, spread: u32) {
        let obstacles = self.rules.task.obstacles() > 0;
        if obstacles {
            let params = self.rules.scatter(everywhere);
            scatter::twin(&self.ended, &mut self.boxes, &mut self.drift, &params);
        }
        reset::twin(
            &self.database.candidates,
            &self.ended,
            &self.boxes,
            &mut self.real,
            &mut self.whole,
            &self.rules.reset(everywhere, spread),
        );
        if obstacles {
            self.sense(true);
        }
    }

    fn sense(&mut self, begun: bool) {
        let params = self.rules.sense(begun);
        sense::twin(
            &self.boxes,
            &self.drift,
            &self.real,
            &self.whole,
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
            &self.real,
            &self.whole,
            &self.ended,
            &self.maps,
            observation,
            params,
        );
    }

    /// Plays one step without starting anew what it ended. `action` is `[envs][TRAJECTORY]`.
    pub fn play(&mut self, action: &[f32]) {
        let obstacles = self.rules.task.obstacles() > 0;
        if obstacles {
            hits::twin(
                action,
                &self.normal,
                &self.boxes,
                &self.real,
                &mut self.whole,
                &self.rules.hits(),
            );
        }
        query::twin(
            &self.database.features,
            &self.whole,
            action,
            &mut self.queries,
            &self.rules.query(),
        );
        let frames = &self.whole[whole::FRAME * self.rules.envs..][..self.rules.envs];
        self.index
            .nearest_all(frames, &self.queries, &mut self.matched);
        if obstacles {
            collide::twin(
                &self.database.candidates,
                &self.matched,
                &self.database.path,
                &self.boxes,
                &self.drift,
                &self.real,
                &mut self.whole,
                &self.rules.collide(),
            );
            wander::twin(&mut self.boxes, &mut self.drift, &self.rules.wander());
        }
        step::twin(
            &self.database.candidates,
            &self.matched,
            &self.database.motion,
            &mut self.real,
            &mut self.whole,
            &mut self.reward,
            &mut self.ended,
            &self.rules.step(),
        );
        if obstacles {
            self.sense(false);
        }
    }

    /// One number of the floating-point state.
    pub fn field(&self, field: usize, env: usize) -> f32 {
        self.real[field * self.rules.envs + env]
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
        self.real = gather(&self.real, old, 1, envs);
        self.whole = gather(&self.whole, old, 1, envs);
        self.boxes = gather(&self.boxes, old, boxes::FIELDS * count, envs);
        self.drift = gather(&self.drift, old, AXES * count, envs);
        self.maps = gather(&self.maps, old, MAP_WORDS, envs);
        self.reward = gather(&self.reward, old, 1, envs);
        self.ended = gather(&self.ended, old, 1, envs);
        self.queries.resize(envs.len(), [0.0; PADDED]);
        self.matched.resize(envs.len(), 0);
        self.rules.envs = envs.len();
    }

    fn tensor<const D: usize>(&self, values: Vec<f32>, shape: [usize; D]) -> Tensor<D> {
        upload(values, shape, &self.device)
    }
}

impl World for CpuWorld {
    fn observe(&mut self) -> Tensor<2> {
        let shape = [self.rules.envs, self.rules.task.width()];
        self.tensor(self.observation(), shape)
    }

    fn act(&mut self, mean: Tensor<2>, log_std: Tensor<1>) -> (Tensor<2>, Tensor<1>) {
        let envs = self.rules.envs;
        let (mut action, mut log_prob) = (vec![0.0; envs * TRAJECTORY], vec![0.0; envs]);
        act::twin(
            &values(mean),
            &values(log_std),
            &mut action,
            &mut log_prob,
            &self.rules.act(),
        );
        (
            self.tensor(action, [envs, TRAJECTORY]),
            self.tensor(log_prob, [envs]),
        )
    }

    fn step(&mut self, action: Tensor<2>) {
        self.play(&values(action));
        let mut last = std::mem::take(&mut self.last);
        self.see(&mut last, &self.rules.observe_last());
        self.last = last;
        self.begin(false, 0);
        self.rules.clock += 1;
        if let Some(watched) = &self.watched {
            let mut state = watched.lock().unwrap_or_else(PoisonError::into_inner);
            state.set(&self.real, &self.whole, &self.boxes);
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
            &self.ended,
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
        let mut sums = [0.0; tally::SUMS];
        let params = self.rules.tally();
        tally::twin(&mut self.real, &mut self.whole, &mut sums, &params);
        self.tensor(sums.to_vec(), [tally::SUMS])
    }

    fn set_level(&mut self, level: u32) {
        self.rules.level = level;
    }

    fn snapshot(&self) -> anyhow::Result<Snapshot> {
        Ok(Snapshot {
            clock: self.rules.clock,
            level: self.rules.level,
            real: self.real.clone(),
            whole: self.whole.clone(),
            boxes: self.boxes.clone(),
            drift: self.drift.clone(),
            maps: self.maps.clone(),
        })
    }

    fn watch(&mut self) -> anyhow::Result<Watched> {
        let mut state = State::default();
        state.set(&self.real, &self.whole, &self.boxes);
        let state = Arc::new(Mutex::new(state));
        self.watched = Some(state.clone());
        Ok(Watched::Cpu(States(vec![state])))
    }

    fn restore(&mut self, snapshot: &Snapshot) {
        (self.rules.clock, self.rules.level) = (snapshot.clock, snapshot.level);
        self.real.clone_from(&snapshot.real);
        self.whole.clone_from(&snapshot.whole);
        self.boxes.clone_from(&snapshot.boxes);
        self.drift.clone_from(&snapshot.drift);
        self.maps.clone_from(&snapshot.maps);
    }
}
