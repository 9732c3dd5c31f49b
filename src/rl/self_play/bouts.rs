//! Who plays whom in a batch of environments, on a device, and how it ends.

use super::pool::BoutResults;
use crate::container::{Section, SectionError};
use crate::gpu::{Array, Device};
use crate::kernels::humanoid::episode_sums;
use crate::kernels::self_play::{OpponentTable, end_bouts};
use anyhow::Result;

/// Whom bouts are against, on the host and on a device.
pub(super) struct SharedTable {
    pub host: OpponentTable,
    /// See [`OpponentTable::words`].
    pub words: Array<u32>,
}

impl SharedTable {
    /// A copy of the table on a device.
    pub fn new(device: &Device, host: OpponentTable) -> SharedTable {
        SharedTable {
            words: Array::from_slice(device, &host.words()),
            host,
        }
    }
}

/// Who plays whom in a batch of environments, and what the bouts came to that have ended.
pub(super) struct Bouts {
    device: Device,
    /// The learner's row in every environment, `[envs]`.
    pub own: Array<u32>,
    /// Number of its opponent, `[envs]`.
    pub opponent: Array<u32>,
    /// Sums over the learner's episodes that have ended, `[stats][envs]`.
    sums: Array,
    /// `[opponents][2]`, see [`end_bouts`].
    tallies: Array<u32>,
}

impl Bouts {
    /// The first bouts, drawn of these opponents.
    pub fn new(device: &Device, opponents: &OpponentTable, params: &end_bouts::Params) -> Bouts {
        let drawn = (0..opponents.envs).map(|env| {
            let [agent, opponent] = end_bouts::draw(opponents, env, params);
            (2 * env as u32 + agent, opponent)
        });
        let (own, opponent): (Vec<u32>, Vec<u32>) = drawn.unzip();
        Bouts {
            own: Array::from_slice(device, &own),
            opponent: Array::from_slice(device, &opponent),
            sums: Array::zeroed(device, opponents.stats * opponents.envs),
            tallies: Array::zeroed(device, 2 * opponents.numbers.len()),
            device: device.clone(),
        }
    }

    /// Counts the bouts that a step has ended, and draws those that begin: see [`end_bouts`].
    pub fn end(
        &mut self,
        opponents: &SharedTable,
        termination: &Array<u32>,
        [now, before]: [&Array; 2],
        params: &end_bouts::Params,
    ) {
        match &self.device {
            Device::Cpu => end_bouts::twin(
                &opponents.host,
                termination.host(),
                now.host(),
                before.host(),
                self.own.host_mut(),
                self.opponent.host_mut(),
                self.sums.host_mut(),
                self.tallies.host_mut(),
                params,
            ),
            Device::Gpu(gpu) => end_bouts::launch(
                gpu,
                opponents.words.buffer(),
                termination.buffer(),
                now.buffer(),
                before.buffer(),
                self.own.buffer(),
                self.opponent.buffer(),
                self.sums.buffer(),
                self.tallies.buffer(),
                params,
            ),
        }
    }

    /// Begins to count anew, for so many opponents.
    pub fn clear_results(&mut self, opponents: usize) {
        self.tallies = Array::zeroed(&self.device, 2 * opponents);
    }

    /// The bouts against opponents of these numbers that have ended.
    ///
    /// # Errors
    /// The device was lost.
    pub fn results(&self, numbers: &[u32]) -> Result<Vec<BoutResults>> {
        let tallies = self.tallies.read(&self.device)?;
        let results = numbers.iter().zip(tallies.chunks_exact(2));
        let results = results.map(|(&opponent, tally)| BoutResults {
            opponent,
            games: tally[0],
            wins: 0.5 * f64::from(tally[1]),
        });
        Ok(results.filter(|result| result.games > 0).collect())
    }

    /// Writes the sums over the learner's episodes, and begins to sum anew.
    pub fn stats(&mut self, out: &mut Array) {
        let envs = self.own.len();
        let params = episode_sums::Params {
            envs: envs as u32,
            start: 0,
            fields: (self.sums.len() / envs) as u32,
        };
        match &self.device {
            Device::Cpu => episode_sums::twin(self.sums.host_mut(), out.host_mut(), &params),
            Device::Gpu(gpu) => {
                episode_sums::launch(gpu, self.sums.buffer(), out.buffer(), &params);
            }
        }
    }

    /// Saves who plays whom, and the sums.
    ///
    /// # Errors
    /// The device was lost.
    pub fn save(&self, to: &mut Section) -> Result<()> {
        let own = self.own.read(&self.device)?;
        let opponents = self.opponent.read(&self.device)?;
        let bouts = own.iter().zip(opponents);
        let bouts = bouts.map(|(own, opponent)| [own % 2, opponent]);
        to.put_array("bouts", &bouts.collect::<Vec<[u32; 2]>>());
        let sums = self.sums.read(&self.device)?;
        let sums = sums.chunks_exact(own.len());
        let sums = sums.map(|envs| envs.iter().sum());
        to.put_array("bout_sums", &sums.collect::<Vec<f32>>());
        Ok(())
    }

    /// Puts back what [`Bouts::save`] saved.
    ///
    /// # Errors
    /// It is not that.
    pub fn load(&mut self, from: &mut Section) -> Result<(), SectionError> {
        let envs = self.own.len();
        let saved = from.take_finite("bout_sums", self.sums.len() / envs)?;
        let bouts: Vec<[u32; 2]> = from.take_array("bouts", envs)?;
        if bouts.iter().any(|&[agent, _]| agent > 1) {
            return Err(SectionError("a bout has more than two agents".into()));
        }
        // Which environments they come from is not told.
        let mut sums = vec![0.0; self.sums.len()];
        for (sums, saved) in sums.chunks_exact_mut(envs).zip(saved) {
            sums[0] = saved;
        }
        let own = (0..).zip(&bouts).map(|(env, [agent, _])| 2 * env + agent);
        let opponents = bouts.iter().map(|&[_, opponent]| opponent);
        let device = &self.device;
        self.own = Array::from_slice(device, &own.collect::<Vec<u32>>());
        self.opponent = Array::from_slice(device, &opponents.collect::<Vec<u32>>());
        self.sums = Array::from_slice(device, &sums);
        Ok(())
    }
}
