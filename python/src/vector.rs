//! Environments stepped together, as Gymnasium's `VectorEnv` means it.

use crate::opened::Opened;
use crate::pool;
use anyhow::Result;
use footwork::env::humanoid::task;
use footwork::env::locomotion::CpuLocomotion;
use footwork::env::{EnvBatch, EnvSpec, Stats, Transition, VecEnv, termination};
use footwork::gpu::{Array, Device};
use footwork::ranks::Ranks;
use footwork::rl::ase::HighLevelEnv;
use footwork::train::config::{Config, ConfigError};
use rayon::prelude::*;
use std::any::Any;
use std::ops::Range;

/// Numbers of an observation lie within this, but for those of maps, which lie between 0 and 1. A simulated body that
/// moves by more than 1000 m/s has diverged, and its episode is over.
pub const OBSERVATION_LIMIT: f32 = 1e6;

/// Numbers of the environments' actions that one of Python's stands for. Motion matching is asked in standard
/// deviations of the motion, of which four are more than is ever asked for; a power of two, so that nothing is rounded.
/// A simulated body's actions cover what its joints can do between -1 and 1 as they are.
pub fn action_scale(spec: &EnvSpec) -> f32 {
    // Motion matching moves in no style but the database's.
    if spec.style == 0 { 4.0 } else { 1.0 }
}

/// When an episode follows the one that a step has ended: Gymnasium's `AutoresetMode`.
#[derive(Clone, Copy, PartialEq)]
pub enum Autoreset {
    /// At once: the observation is the next episode's first.
    SameStep,
    /// In the next step, whose action is ignored.
    NextStep,
    /// When it is asked for.
    Disabled,
}

/// What a step leaves; rows are agents.
pub struct Step {
    /// `[rows][observation]`
    pub observation: Vec<f32>,
    /// `[rows]`
    pub reward: Vec<f32>,
    pub terminated: Vec<bool>,
    pub truncated: Vec<bool>,
    /// Rows whose episode has ended.
    pub ended: Vec<usize>,
    /// What they observed last, `[ended][observation]`.
    pub final_observation: Vec<f32>,
    /// What is known of their episodes, `[ended][stats]`.
    pub stats: Vec<f32>,
}

/// A part of the environments, with the columns that a step reads and writes.
struct Part {
    rows: Range<usize>,
    action: Array,
    reward: Array,
    style_reward: Array,
    termination: Array<u32>,
    group: Array<u32>,
    final_observation: Array,
}

/// A batch of environments of one task.
pub struct Vector {
    opened: Opened,
    envs: usize,
    seed: u32,
    pub autoreset: Autoreset,
    batch: EnvBatch,
    parts: Vec<Part>,
    pub spec: EnvSpec,
    /// Names of an episode's statistics.
    pub stat_names: &'static [&'static str],
    /// Nobody has been told the first observation.
    fresh: bool,
    /// Rows whose episode has ended and was followed by no other, with what they observed last.
    over: Vec<Option<Vec<f32>>>,
    /// Sums over the episodes that ended since they were last taken.
    sums: Vec<f64>,
}

impl Vector {
    /// Environments with `rows` agents in all, at the start of an episode.
    ///
    /// # Errors
    /// The choices or the data cannot be used.
    pub fn new(mut config: Config, rows: i64, autoreset: Autoreset) -> Result<Vector> {
        config.ppo.envs = envs_of(&config.task.name, rows)?;
        // Nothing is learned here: only a step must fit.
        config.ppo.rollout_length = 1;
        let opened = pool::install(|| Opened::new(&mut config))?;
        let (envs, seed) = (config.ppo.envs, config.seed);
        let batch = pool::install(|| open(&opened, envs, seed))?;
        let (spec, stat_names) = (batch.spec(), batch.stat_names());
        Ok(Vector {
            parts: parts(&batch),
            over: vec![None; spec.rows()],
            sums: vec![0.0; stat_names.len()],
            opened,
            envs,
            seed,
            autoreset,
            batch,
            spec,
            stat_names,
            fresh: true,
        })
    }

    /// What the user should know of how the data was loaded.
    pub fn notes(&self) -> &[String] {
        &self.opened.notes
    }

    /// Level of the curriculum that new episodes are of, if there are levels.
    pub fn level(&self) -> Option<u32> {
        self.batch
            .curriculum
            .as_ref()
            .map(|curriculum| curriculum.level())
    }

    /// Begins new episodes in all environments; a seed decides over all that is random from then on.
    ///
    /// # Errors
    /// The environments cannot be opened.
    pub fn reset(&mut self, seed: Option<u32>) -> Result<Vec<f32>> {
        if let Some(seed) = seed.filter(|&seed| !self.fresh || seed != self.seed) {
            self.batch = pool::install(|| open(&self.opened, self.envs, seed))?;
            self.seed = seed;
        } else if !self.fresh {
            self.restart(&vec![true; self.envs])?;
        }
        self.fresh = false;
        self.over.fill(None);
        Ok(self.observe())
    }

    /// Begins new episodes in the environments of the rows that are marked.
    ///
    /// # Errors
    /// The environments cannot be restarted.
    pub fn reset_rows(&mut self, rows: &[bool]) -> Result<Vec<f32>> {
        let marked = rows.chunks_exact(self.spec.agents);
        let over = self.over.chunks_exact(self.spec.agents);
        let running = over.map(|over| over[0].is_none());
        // What has ended was followed by a new episode that nobody has seen.
        let which = marked
            .zip(running)
            .map(|(marked, running)| running && marked.contains(&true));
        let which: Vec<bool> = which.collect();
        if which.contains(&true) {
            self.restart(&which)?;
        }
        for (row, over) in self.over.iter_mut().enumerate() {
            let env = row / self.spec.agents * self.spec.agents;
            if rows[env..][..self.spec.agents].contains(&true) {
                *over = None;
            }
        }
        Ok(self.observe())
    }

    fn restart(&mut self, which: &[bool]) -> Result<()> {
        let agents = self.spec.agents;
        let parts = self.batch.parts.par_iter_mut().zip(&self.parts);
        pool::install(|| {
            parts.try_for_each(|(envs, part)| {
                envs.restart(&which[part.rows.start / agents..part.rows.end / agents])
            })
        })
    }

    /// The first row whose episode is over and must be reset before a step.
    pub fn first_over(&self) -> Option<usize> {
        match self.autoreset {
            Autoreset::Disabled => self.over.iter().position(Option::is_some),
            _ => None,
        }
    }

    /// Plays a step with `actions`, `[rows][action]`.
    ///
    /// # Errors
    /// The environments cannot go on.
    pub fn step(&mut self, actions: &[f32]) -> Result<Step> {
        self.fresh = false;
        self.play(actions);
        // Rows whose step is that of a reset.
        let resets: Vec<bool> = self.over.iter().map(Option::is_some).collect();
        let rows = self.spec.rows();
        let mut step = Step {
            observation: Vec::new(),
            reward: Vec::with_capacity(rows),
            terminated: vec![false; rows],
            truncated: vec![false; rows],
            ended: Vec::new(),
            final_observation: Vec::new(),
            stats: Vec::new(),
        };
        let mut any = false;
        for part in &self.parts {
            step.reward.extend_from_slice(part.reward.host());
            for (row, &end) in part.rows.clone().zip(part.termination.host()) {
                any |= end != termination::RUNNING;
                if end != termination::RUNNING && !resets[row] {
                    let goes_on = self.spec.bootstrap >> end & 1 == 1;
                    (step.terminated[row], step.truncated[row]) = (!goes_on, goes_on);
                    step.ended.push(row);
                    step.final_observation.extend(part.last(row, &self.spec));
                }
            }
        }
        if any {
            self.count(&mut step)?;
        }
        if resets.contains(&true) {
            self.finish_resets(&resets, &mut step)?;
        }
        if self.autoreset != Autoreset::SameStep {
            let last = step
                .final_observation
                .chunks_exact(self.spec.observation.dim());
            for (&row, last) in step.ended.iter().zip(last) {
                self.over[row] = Some(last.to_vec());
            }
        }
        step.observation = self.observe();
        Ok(step)
    }

    fn play(&mut self, actions: &[f32]) {
        let (width, scale) = (self.spec.action, action_scale(&self.spec));
        let parts = self.batch.parts.par_iter_mut().zip(&mut self.parts);
        pool::install(|| {
            parts.for_each(|(envs, part)| {
                let actions = &actions[part.rows.start * width..part.rows.end * width];
                for (own, action) in part.action.host_mut().iter_mut().zip(actions) {
                    *own = action * scale;
                }
                let transition = Transition {
                    step: 0,
                    reward: &mut part.reward,
                    style_reward: &mut part.style_reward,
                    termination: &mut part.termination,
                    group: &mut part.group,
                    final_observation: &mut part.final_observation,
                };
                envs.step(&part.action, 0, transition);
            });
        });
    }

    /// The step of rows whose episode was over comes to nothing: they begin another.
    fn finish_resets(&mut self, resets: &[bool], step: &mut Step) -> Result<()> {
        for (reward, _) in step
            .reward
            .iter_mut()
            .zip(resets)
            .filter(|(_, reset)| **reset)
        {
            *reward = 0.0;
        }
        let envs = resets.chunks_exact(self.spec.agents);
        let which: Vec<bool> = envs.map(|agents| agents[0]).collect();
        self.over.fill(None);
        self.restart(&which)
    }

    /// Takes in what is known of the episodes that a step has ended.
    fn count(&mut self, step: &mut Step) -> Result<()> {
        let names = self.stat_names.len();
        let mut ended = step.ended.iter().peekable();
        let mut sums = vec![0.0; names];
        let mut drained = Array::Host(vec![0.0; names]);
        for (envs, part) in self.batch.parts.iter_mut().zip(&self.parts) {
            let known = envs.row_stats();
            while let Some(&row) = ended.next_if(|row| part.rows.contains(row)) {
                let Some(known) = &known else {
                    continue;
                };
                let own = known.host().iter().skip(row - part.rows.start);
                let own = own.step_by(part.rows.len()).copied();
                for (sum, own) in sums.iter_mut().zip(own) {
                    *sum += own;
                    step.stats.push(own);
                }
            }
            envs.stats(&mut drained);
        }
        self.sums
            .iter_mut()
            .zip(&sums)
            .for_each(|(all, sum)| *all += f64::from(*sum));
        self.batch
            .advance_curriculum(&Stats::new(self.stat_names, &sums));
        Ok(())
    }

    /// Means over the episodes that ended since the last call, and how many these were.
    pub fn take_means(&mut self) -> Vec<(&'static str, f64)> {
        let count = self.sums[0].max(1.0);
        let sums = self.stat_names.iter().zip(&mut self.sums).enumerate();
        sums.map(|(at, (name, sum))| {
            let sum = std::mem::take(sum);
            (*name, if at == 0 { sum } else { sum / count })
        })
        .collect()
    }

    fn observe(&mut self) -> Vec<f32> {
        let width = self.spec.observation.dim();
        let mut all = Array::Host(vec![0.0; self.spec.rows() * width]);
        for (envs, part) in self.batch.parts.iter_mut().zip(&self.parts) {
            envs.observe(&mut all, part.rows.start * width);
        }
        for (row, last) in self.over.iter().enumerate() {
            if let Some(last) = last {
                all.host_mut()[row * width..][..width].copy_from_slice(last);
            }
        }
        match all {
            Array::Host(numbers) => numbers,
            Array::Gpu(_) => unreachable!("an array of the CPU"),
        }
    }
}

impl Part {
    /// What a row observed last, whose episode has ended; of a body that has diverged within what can be observed.
    fn last(&self, row: usize, spec: &EnvSpec) -> impl Iterator<Item = f32> {
        let width = spec.observation.dim();
        let last = &self.final_observation.host()[(row - self.rows.start) * width..][..width];
        last.iter().map(|number| match number.is_nan() {
            true => 0.0,
            false => number.clamp(-OBSERVATION_LIMIT, OBSERVATION_LIMIT),
        })
    }
}

/// Environments whose agents are so many rows.
fn envs_of(task: &str, rows: i64) -> Result<usize, ConfigError> {
    let agents = if task == "box" { 2 } else { 1 };
    match usize::try_from(rows) {
        Ok(rows) if rows > 0 && rows.is_multiple_of(agents) => Ok(rows / agents),
        _ => Err(ConfigError::Value {
            key: "num_envs",
            value: rows.to_string(),
            why: format!(
                "it must be a positive multiple of {agents}, the number of an environment's agents"
            ),
        }),
    }
}

/// Opens environments whose first episodes have their full length. Those of two agents are opened as they are, without
/// the opponents of self-play.
fn open(opened: &Opened, envs: usize, seed: u32) -> Result<EnvBatch> {
    let (task, device) = (&*opened.task, &Device::Cpu);
    let mut batch = match task.bouts() {
        None => task.open(device, &Ranks::alone(), envs, seed)?,
        Some(bouts) => EnvBatch::open(device, &Ranks::alone(), envs, None, |part| {
            let bodies = task::open(device, bouts.task.clone(), part, seed)?;
            Ok(match task.low_level() {
                Some(low_level) => Box::new(HighLevelEnv::new(bodies, low_level, device)?),
                None => bodies,
            })
        })?,
    };
    for part in &mut batch.parts {
        let part: &mut dyn VecEnv = &mut **part;
        part.restart(&vec![true; part.spec().envs])?;
        // Whoever learns from these may ask for the last observation of any episode.
        if let Some(locomotion) = (part as &mut dyn Any).downcast_mut::<CpuLocomotion>() {
            locomotion.params.final_observations = termination::ANY & !(1 << termination::RUNNING);
        }
    }
    Ok(batch)
}

fn parts(batch: &EnvBatch) -> Vec<Part> {
    let mut first = 0;
    let mut part = |spec: &EnvSpec| {
        let rows = spec.rows();
        let numbers = |count| Array::Host(vec![0.0; count]);
        first += rows;
        Part {
            rows: first - rows..first,
            action: numbers(rows * spec.action),
            reward: numbers(rows),
            style_reward: numbers(rows),
            termination: Array::Host(vec![0; rows]),
            group: Array::Host(vec![0; rows]),
            final_observation: numbers(rows * spec.observation.dim()),
        }
    };
    batch.parts.iter().map(|envs| part(envs.spec())).collect()
}
