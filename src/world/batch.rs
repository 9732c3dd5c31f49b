//! The worlds of a training, in parts that are played apart from each other.
//!
//! On the CPU a core plays one part through a whole rollout. If all parts went step by step together, at
//! every step cores would wait for the slowest, and for what one alone does between steps. On a GPU
//! all worlds are one part.

use super::cpu::CpuWorld;
use super::watched::{States, Watched};
use super::{Setup, Snapshot, World, open};
use crate::gpu::Device;
use crate::motion::database::Database;
use burn::tensor::Tensor;
use std::ops::Range;
use std::sync::Arc;

/// Parts on the CPU. Not one for every core, for what is summed up over parts must not depend on the
/// number of cores; where there are more, they share in the searches of a part.
const PARTS: usize = 4;

pub struct Batch {
    pub parts: Vec<Box<dyn World>>,
    envs: usize,
}

impl Batch {
    /// All at the start of an episode, as [`open`] leaves them.
    pub fn open(device: &Device, database: &Arc<Database>, setup: &Setup) -> Self {
        let part = |envs: Range<usize>| -> Box<dyn World> {
            let part = Setup {
                envs: envs.len(),
                ..*setup
            };
            let database = database.clone();
            Box::new(CpuWorld::part(database, &part, envs.start, setup.spread()))
        };
        Batch {
            parts: match device {
                Device::Cpu => ranges(setup.envs, PARTS).map(part).collect(),
                Device::Gpu(_) => vec![open(device, database, setup)],
            },
            envs: setup.envs,
        }
    }

    /// As [`World::tally`], of all.
    pub fn tally(&mut self) -> Tensor<1> {
        let sums = self.parts.iter_mut().map(|part| part.tally());
        let Some(sums) = sums.reduce(Tensor::add) else {
            unreachable!("a batch has a part")
        };
        sums
    }

    /// As [`World::set_level`].
    pub fn set_level(&mut self, level: u32) {
        self.parts.iter_mut().for_each(|part| part.set_level(level));
    }

    /// As [`World::snapshot`].
    ///
    /// # Errors
    /// The device was lost.
    pub fn snapshot(&self) -> anyhow::Result<Snapshot> {
        let parts = self.parts.iter().map(|part| part.snapshot());
        Ok(Snapshot::join(&parts.collect::<anyhow::Result<Vec<_>>>()?))
    }

    /// As [`World::restore`].
    pub fn restore(&mut self, snapshot: &Snapshot) {
        let envs = ranges(self.envs, self.parts.len());
        for (part, envs) in self.parts.iter_mut().zip(envs) {
            part.restore(&snapshot.part(envs));
        }
    }

    /// As [`World::watch`].
    ///
    /// # Errors
    /// The device was lost.
    pub fn watch(&mut self) -> anyhow::Result<Watched> {
        let mut states = Vec::new();
        for part in &mut self.parts {
            match part.watch()? {
                Watched::Cpu(state) => states.extend(state.0),
                // A GPU has but one part.
                buffers => return Ok(buffers),
            }
        }
        Ok(Watched::Cpu(States(states)))
    }
}

/// `0..envs` in so many parts, or in as many as there can be.
fn ranges(envs: usize, parts: usize) -> impl Iterator<Item = Range<usize>> {
    let parts = parts.min(envs).max(1);
    (0..parts).map(move |part| envs * part / parts..envs * (part + 1) / parts)
}
