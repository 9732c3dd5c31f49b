//! A policy on the host, as evaluation, viewers and checkpoints use it.

use super::actor_critic::ActorCritic;
use super::cpu;
use super::network::{NetworkConfig, NetworkError};
use super::running_mean_std::RunningMeanStd;
use crate::container::{Section, SectionError};
use crate::env::ObservationSpec;
use crate::gpu::Array;
use anyhow::Result;

/// An actor and its critic, and what normalises their observations.
#[derive(Clone)]
pub struct Policy {
    config: NetworkConfig,
    networks: ActorCritic,
    /// The flat vector that [`ActorCritic`] describes.
    pub parameters: Vec<f32>,
    /// In host memory; none if observations are taken as they are.
    pub normalizer: Option<RunningMeanStd>,
}

impl Policy {
    /// A policy whose parameters are all zero.
    ///
    /// # Errors
    /// There can be no such networks, or not for such observations.
    pub fn new(
        config: &NetworkConfig,
        observation: &ObservationSpec,
        action: usize,
        values: usize,
    ) -> Result<Self, NetworkError> {
        let networks = ActorCritic::new(config, observation, action, values)?;
        Ok(Policy {
            config: config.clone(),
            parameters: vec![0.0; networks.parameters()],
            networks,
            normalizer: None,
        })
    }

    /// The networks' hidden layers.
    pub fn config(&self) -> &NetworkConfig {
        &self.config
    }

    /// The networks, and where their parameters lie.
    pub fn networks(&self) -> &ActorCritic {
        &self.networks
    }

    /// What it observes.
    pub fn observation(&self) -> &ObservationSpec {
        self.networks.actor.observation()
    }

    /// Numbers of an action.
    pub fn action(&self) -> usize {
        self.networks.actor.outputs()
    }

    /// Natural logarithms of the standard deviations of the actions.
    pub fn log_std(&self) -> &[f32] {
        &self.parameters[self.networks.log_std()]
    }

    /// Checksum of the parameters.
    pub fn hash(&self) -> u32 {
        crc32fast::hash(bytemuck::cast_slice(&self.parameters))
    }

    /// Whether another policy differs by its numbers alone.
    pub fn has_form_of(&self, other: &Policy) -> bool {
        let form = |policy: &Policy| (policy.networks.clone(), policy.normalizer.is_some());
        form(self) == form(other)
    }

    /// Mean actions `[n][action]` for observations `[n][observation]`, on all cores.
    pub fn mean(&self, observations: &[f32]) -> Vec<f32> {
        let rows = observations.len() / self.observation().dim();
        let mut out = vec![0.0; rows * self.action()];
        let actor = &self.networks.actor;
        match &self.normalizer {
            None => cpu::forward(actor, &self.parameters, observations, &mut out),
            Some(normalizer) => {
                let mut normalized = Array::Host(observations.to_vec());
                normalizer.normalize_in_place(&mut normalized, rows);
                cpu::forward(actor, &self.parameters, normalized.host(), &mut out);
            }
        }
        out
    }

    /// The mean action for one observation, on this core alone. From the second one on nothing is allocated.
    pub fn mean_one<'a>(&self, observation: &[f32], scratch: &'a mut PolicyScratch) -> &'a [f32] {
        let PolicyScratch { normalized, pass } = scratch;
        let actor = &self.networks.actor;
        let Some(normalizer) = &self.normalizer else {
            return cpu::forward_one(actor, &self.parameters, observation, pass);
        };
        normalized.clear();
        normalized.extend_from_slice(observation);
        normalizer.normalize_row(normalized);
        cpu::forward_one(actor, &self.parameters, normalized, pass)
    }

    /// Saves everything.
    ///
    /// # Errors
    /// None: the policy is in host memory.
    pub fn save(&self, to: &mut Section) -> Result<()> {
        to.put("network", &self.config);
        to.put("observation", self.observation());
        to.put("action", self.action());
        to.put("values", self.networks.critic.outputs());
        to.put("normalized", self.normalizer.is_some());
        to.put_array("parameters", &self.parameters);
        self.normalizer
            .as_ref()
            .map_or(Ok(()), |normalizer| normalizer.save(to))
    }

    /// Reads a policy that [`Policy::save`] wrote.
    ///
    /// # Errors
    /// Something is missing, damaged, or fits nothing else.
    pub fn load(from: &mut Section) -> Result<Policy, SectionError> {
        let config: NetworkConfig = from.get("network")?;
        let observation: ObservationSpec = from.get("observation")?;
        let possible = |dim: usize| (1..=MAX_DIM).contains(&dim);
        let grid = observation.grid.unwrap_or([1; 3]);
        let action: usize = from.get("action")?;
        let values: usize = from.get("values")?;
        if !possible(action)
            || !possible(values)
            || observation.vector > MAX_DIM
            || !grid.into_iter().all(possible)
        {
            let message = format!(
                "its observation {observation:?}, action {action} or values {values} cannot be"
            );
            return Err(SectionError(message));
        }
        let policy = Policy::new(&config, &observation, action, values);
        let mut policy = policy.map_err(|error| SectionError(format!("its network: {error}")))?;
        policy.parameters = from.take_finite("parameters", policy.parameters.len())?;
        if from.get("normalized")? {
            policy.normalizer = Some(RunningMeanStd::load(from, observation.dim())?);
        }
        Ok(policy)
    }
}

/// The memory of [`Policy::mean_one`], which a next evaluation of the same policy uses again.
#[derive(Clone, Default)]
pub struct PolicyScratch {
    normalized: Vec<f32>,
    pass: cpu::ForwardScratch,
}

/// The largest dimension that a file may ask for.
const MAX_DIM: usize = 1 << 16;
