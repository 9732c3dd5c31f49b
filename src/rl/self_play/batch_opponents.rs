//! Opponents on a device, who act in a batch of bouts.

use super::Opponent;
use super::bouts::{Bouts, SharedTable};
use super::frozen_policies::FrozenPolicies;
use super::opponents::Opponents;
use crate::gpu::{Array, Device};
use crate::kernels::self_play::{bout_actions, group_bouts, scripted_actions};
use crate::nn::{NetworkCopies, Policy};
use anyhow::Result;
use std::sync::Arc;

/// Opponents on a device, who act in a batch of bouts. All policies among them are evaluated together, each for the
/// rows of its own bouts.
pub(super) struct BatchOpponents {
    device: Device,
    opponents: Arc<Opponents>,
    pub table: SharedTable,
    policies: Option<FrozenPolicies>,
    scripts: Scripts,
    /// See [`group_bouts`].
    place: Array<u32>,
    slots: Array<u32>,
    blocks: Array<u32>,
    /// In place of what policies leave where there are none.
    nothing: Array,
    /// Numbers of an observation and of an action.
    widths: [usize; 2],
}

/// Opponents who follow a script, on a device: see [`scripted_actions`].
struct Scripts {
    words: Array<u32>,
    strides: Array,
}

/// What the opponents' noise depends on, besides the environment.
#[derive(Clone, Copy)]
pub(super) struct NoiseKey {
    /// Number of the first environment in the whole batch.
    pub first: u32,
    pub seed: u32,
    pub step_counter: u32,
}

impl BatchOpponents {
    /// Opponents in so many environments, with so many statistics, of observations and actions of these `widths`.
    ///
    /// # Errors
    /// The device has no room for them.
    pub fn new(
        opponents: &Arc<Opponents>,
        device: &Device,
        [envs, stats]: [usize; 2],
        widths: [usize; 2],
    ) -> Result<Self> {
        let table = opponents.table(envs, stats);
        let block = NetworkCopies::block(device);
        let blocks = group_bouts::blocks(envs, table.policies(), block);
        let policies = opponents.iter().filter_map(Opponent::policy);
        let policies: Vec<&Policy> = policies.collect();
        let frozen = match policies.is_empty() {
            true => None,
            false => Some(FrozenPolicies::new(&policies, device, blocks * block)?),
        };
        Ok(BatchOpponents {
            table: SharedTable::new(device, table),
            policies: frozen,
            scripts: Scripts::new(opponents, device, widths),
            place: Array::zeroed(device, envs),
            slots: Array::zeroed(device, blocks * block),
            blocks: Array::zeroed(device, blocks),
            nothing: Array::zeroed(device, 1),
            device: device.clone(),
            opponents: opponents.clone(),
            widths,
        })
    }

    /// The opponents from now on. Those who are the same stay on the device.
    ///
    /// # Errors
    /// It has no room for them.
    pub fn set(&mut self, opponents: &Arc<Opponents>) -> Result<()> {
        let dims = [self.table.host.envs, self.table.host.stats];
        if self.opponents.are(opponents) {
            let table = opponents.table(dims[0], dims[1]);
            self.table = SharedTable::new(&self.device, table);
            self.opponents = opponents.clone();
        } else {
            *self = BatchOpponents::new(opponents, &self.device, dims, self.widths)?;
        }
        Ok(())
    }

    /// Writes the actions of all agents, `[2 envs][action]`, when they observe `[2 envs][observation]`: the learner's, which
    /// it holds `[envs][action]` from the index `at` on, and the opponents'.
    pub fn act(
        &mut self,
        bouts: &Bouts,
        observation: &Array,
        learner: &Array,
        at: usize,
        key: NoiseKey,
        action: &mut Array,
    ) {
        self.group(bouts);
        if let Some(policies) = &mut self.policies {
            policies.evaluate(&self.slots, &self.blocks, &bouts.own, observation);
        }
        self.join(bouts, learner, at, key, action);
        self.scripts
            .act(&self.device, &bouts.own, &self.place, observation, action);
    }

    fn group(&mut self, bouts: &Bouts) {
        let params = group_bouts::Params {
            block: (self.slots.len() / self.blocks.len()) as u32,
            blocks: self.blocks.len() as u32,
        };
        match &self.device {
            Device::Cpu => group_bouts::twin(
                &self.table.host,
                bouts.opponent.host(),
                self.place.host_mut(),
                self.slots.host_mut(),
                self.blocks.host_mut(),
                &params,
            ),
            Device::Gpu(gpu) => group_bouts::launch(
                gpu,
                self.table.words.buffer(),
                bouts.opponent.buffer(),
                self.place.buffer(),
                self.slots.buffer(),
                self.blocks.buffer(),
                &params,
            ),
        }
    }

    /// Writes what the learner and the policies do.
    fn join(&self, bouts: &Bouts, learner: &Array, at: usize, key: NoiseKey, action: &mut Array) {
        let policies = self.policies.as_ref();
        let buffers = policies.map(|all| [&all.mean, &all.parameters]);
        let [mean, parameters] = buffers.unwrap_or([&self.nothing; 2]);
        let params = bout_actions::Params {
            envs: self.table.host.envs as u32,
            action: self.widths[1] as u32,
            at: at as u32,
            block: (self.slots.len() / self.blocks.len()) as u32,
            parameters: policies.map_or(0, |all| all.parameters_each as u32),
            log_std: policies.map_or(0, |all| all.log_std as u32),
            first: key.first,
            seed: key.seed,
            step_counter: key.step_counter,
        };
        match &self.device {
            Device::Cpu => bout_actions::twin(
                bouts.own.host(),
                self.place.host(),
                self.blocks.host(),
                learner.host(),
                mean.host(),
                parameters.host(),
                action.host_mut(),
                &params,
            ),
            Device::Gpu(gpu) => bout_actions::launch(
                gpu,
                bouts.own.buffer(),
                self.place.buffer(),
                self.blocks.buffer(),
                learner.buffer(),
                mean.buffer(),
                parameters.buffer(),
                action.buffer(),
                &params,
            ),
        }
    }
}

impl Scripts {
    fn new(opponents: &Opponents, device: &Device, [observation, action]: [usize; 2]) -> Scripts {
        let (mut words, mut strides) = (vec![action as u32, observation as u32], Vec::new());
        for script in opponents.iter().filter_map(Opponent::script) {
            let first = strides.len() / (2 + action);
            let numbers = [script.target, first, script.strides.len()];
            words.extend(numbers.map(|number| number as u32));
            for stride in &script.strides {
                strides.extend([stride.forward, stride.turn]);
                strides.extend(&stride.action);
            }
        }
        // An array holds something.
        strides.push(0.0);
        Scripts {
            words: Array::from_slice(device, &words),
            strides: Array::from_slice(device, &strides),
        }
    }

    /// Writes what scripts do.
    fn act(
        &self,
        device: &Device,
        own: &Array<u32>,
        place: &Array<u32>,
        observation: &Array,
        action: &mut Array,
    ) {
        let params = scripted_actions::Params {
            envs: own.len() as u32,
        };
        match device {
            Device::Cpu => scripted_actions::twin(
                own.host(),
                place.host(),
                self.words.host(),
                self.strides.host(),
                observation.host(),
                action.host_mut(),
                &params,
            ),
            Device::Gpu(gpu) => scripted_actions::launch(
                gpu,
                own.buffer(),
                place.buffer(),
                self.words.buffer(),
                self.strides.buffer(),
                observation.buffer(),
                action.buffer(),
                &params,
            ),
        }
    }
}
