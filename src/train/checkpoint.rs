//! A run at one moment, complete: it goes on from here as if it had never stopped.

use super::config::Config;
use crate::gpu::Device;
use crate::kernels::locomotion::locomotion_layout::{VELOCITY_DIM, MAP_WORDS, boxes, state_f32, state_u32};
use crate::rl::ppo::Ppo;
use crate::nn::adam::Adam;
use crate::nn::network::{Network, Shape};
use crate::rl::value_normalizer::Scale;
use crate::rl::ppo::update::Learner;
use crate::container::{Arrays, Format, StoreError};
use crate::nn::tensors::{read, vector};
use crate::env::locomotion::{EnvState, Task};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

const FORMAT: Format = Format {
    kind: "checkpt",
    version: 3,
};

/// What a policy was trained for, and how far the run had come.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Header {
    pub task: Task,
    /// Numbers of an observation.
    pub observation: usize,
    /// Of the database: a policy is of no use with another.
    pub database: u32,
    pub network: Network,
    /// All choices of learning, as TOML.
    pub ppo: String,
    pub seed: u32,
    pub steps: u64,
    pub wall_s: f64,
    pub updates: u64,
    /// Learning rate and KL coefficient, kept among the arrays: JSON may round them.
    #[serde(skip)]
    pub rates: [f64; 2],
    pub adam_steps: u64,
    pub scale_updates: u64,
    pub world: EnvState,
    /// What the trainer remembers besides: see [`super::trainer`].
    pub memory: super::trainer::Memory,
}

/// Header and arrays.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint {
    pub header: Header,
    pub shape: Shape,
    pub parameters: Vec<f32>,
    pub first_moment: Vec<f32>,
    pub second_moment: Vec<f32>,
    pub value_moments: Vec<f32>,
}

/// Why a checkpoint does not fit.
#[derive(Debug, thiserror::Error)]
pub enum CheckpointError {
    #[error(transparent)]
    Store(#[from] StoreError),
    #[error(
        "{path} was trained with another database (fingerprint {found:08x}, this one has {wanted:08x}): it is not the data the run was started with; bring that back or name it with --data, or start another run"
    )]
    Database {
        path: PathBuf,
        found: u32,
        wanted: u32,
    },
    #[error(
        "`{key}` in the run's config.toml is not what the run was started with: put it back, or start another run"
    )]
    Changed { key: &'static str },
    #[error(
        "{path} is of the task `{found}` with {found_width} observations, not of `{wanted}` with {wanted_width}"
    )]
    Task {
        path: PathBuf,
        found: &'static str,
        found_width: usize,
        wanted: &'static str,
        wanted_width: usize,
    },
}

impl Checkpoint {
    /// Copies a run's state to the host.
    ///
    /// # Errors
    /// The device failed.
    pub fn take(header: Header, learner: &Learner) -> anyhow::Result<Self> {
        Ok(Checkpoint {
            header,
            shape: learner.shape.clone(),
            parameters: read(learner.parameters.clone())?,
            first_moment: read(learner.adam.first.clone())?,
            second_moment: read(learner.adam.second.clone())?,
            value_moments: read(learner.scale.moments.clone())?,
        })
    }

    /// Puts the state into a fresh learner of the same configuration.
    ///
    /// # Errors
    /// See [`Learner::new`].
    pub fn learner(&self, config: &Ppo, device: &Device) -> anyhow::Result<Learner> {
        let header = &self.header;
        let mut learner = Learner::new(config, header.observation, device, header.seed)?;
        let device = &device.tensors();
        learner.parameters = vector(&self.parameters, device);
        learner.adam = Adam {
            first: vector(&self.first_moment, device),
            second: vector(&self.second_moment, device),
            steps: self.header.adam_steps,
        };
        learner.scale = Scale {
            moments: vector(&self.value_moments, device),
            updates: self.header.scale_updates,
        };
        [learner.learning_rate, learner.kl_coefficient] = self.header.rates;
        learner.updates = self.header.updates;
        Ok(learner)
    }

    pub fn save(&self, path: &Path) -> Result<(), StoreError> {
        let mut arrays = Arrays::default();
        arrays.put("parameters", &self.parameters);
        arrays.put("first_moment", &self.first_moment);
        arrays.put("second_moment", &self.second_moment);
        arrays.put("value_moments", &self.value_moments);
        arrays.put("real", &self.header.world.state_f32);
        arrays.put("whole", &self.header.world.state_u32);
        arrays.put("boxes", &self.header.world.boxes);
        arrays.put("drift", &self.header.world.obstacle_velocity);
        arrays.put("maps", &self.header.world.maps);
        arrays.put("rates", &self.header.rates);
        crate::container::save(path, FORMAT, &self.header, &arrays)
    }

    pub fn load(path: &Path) -> Result<Self, StoreError> {
        let (mut header, mut arrays) = crate::container::load::<Header>(path, FORMAT)?;
        let damaged = |why: &str| StoreError::Damaged {
            path: path.to_path_buf(),
            why: why.to_string(),
        };
        let mut floats = |name: &str| {
            arrays
                .take::<f32>(name)
                .ok_or_else(|| damaged(&format!("no {name}")))
        };
        let parameters = floats("parameters")?;
        let (first_moment, second_moment) = (floats("first_moment")?, floats("second_moment")?);
        let value_moments = floats("value_moments")?;
        header.world.state_f32 = floats("real")?;
        header.world.boxes = floats("boxes")?;
        header.world.obstacle_velocity = floats("drift")?;
        header.world.state_u32 = arrays.take("whole").ok_or_else(|| damaged("no whole"))?;
        header.world.maps = arrays.take("maps").ok_or_else(|| damaged("no maps"))?;
        let rates: Vec<f64> = arrays.take("rates").ok_or_else(|| damaged("no rates"))?;
        let shape = Shape::new(&header.network, header.observation)
            .filter(|_| header.observation == header.task.width())
            .ok_or_else(|| damaged("its network does not fit its task"))?;
        let expected = shape.parameters();
        let envs = header.world.state_u32.len() / state_u32::FIELDS;
        let numbers = [
            &parameters,
            &first_moment,
            &second_moment,
            &value_moments,
            &header.world.state_f32,
            &header.world.boxes,
            &header.world.obstacle_velocity,
        ];
        if !numbers
            .into_iter()
            .flatten()
            .all(|number| number.is_finite())
        {
            return Err(damaged("it has numbers that are not finite"));
        }
        let Ok(rates) = <[f64; 2]>::try_from(rates) else {
            return Err(damaged("its rates are not two"));
        };
        header.rates = rates;
        if !rates.iter().all(|rate| rate.is_finite()) {
            return Err(damaged("it has numbers that are not finite"));
        }
        let fits = envs > 0
            && [parameters.len(), first_moment.len(), second_moment.len()] == [expected; 3]
            && value_moments.len() == 2
            && header.world.state_f32.len() == envs * state_f32::FIELDS
            && header.world.state_u32.len() == envs * state_u32::FIELDS
            && header.world.boxes.len() == envs * boxes::FIELDS * header.task.obstacles()
            && header.world.obstacle_velocity.len() == envs * VELOCITY_DIM * header.task.obstacles()
            && header.world.maps.len() == envs * MAP_WORDS;
        if !fits {
            return Err(damaged("its arrays do not fit together"));
        }
        Ok(Checkpoint {
            header,
            shape,
            parameters,
            first_moment,
            second_moment,
            value_moments,
        })
    }

    /// Refuses to go on under another configuration than the one the run was started with.
    pub fn check_same(&self, config: &Config) -> Result<(), CheckpointError> {
        let (header, envs) = (&self.header, self.header.world.state_u32.len() / state_u32::FIELDS);
        let same = [
            ("ppo.envs", envs == config.ppo.envs),
            ("ppo.network", header.network == config.ppo.network),
            ("ppo", config.ppo.to_toml() == header.ppo),
            (header.task.name(), header.task == config.task),
            ("seed", header.seed == config.seed),
        ];
        match same.into_iter().find(|(_, same)| !same) {
            None => Ok(()),
            Some((key, _)) => Err(CheckpointError::Changed { key }),
        }
    }

    /// Loads a checkpoint of a task for a database.
    pub fn load_for(path: &Path, task: &Task, database: u32) -> Result<Self, CheckpointError> {
        let checkpoint = Self::load(path)?;
        let header = &checkpoint.header;
        if header.task.name() != task.name() || header.observation != task.width() {
            return Err(CheckpointError::Task {
                path: path.to_path_buf(),
                found: header.task.name(),
                found_width: header.observation,
                wanted: task.name(),
                wanted_width: task.width(),
            });
        }
        if header.database != database {
            return Err(CheckpointError::Database {
                path: path.to_path_buf(),
                found: header.database,
                wanted: database,
            });
        }
        Ok(checkpoint)
    }
}
