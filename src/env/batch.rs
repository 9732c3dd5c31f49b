//! The environments of a training, in parts that are played apart from each other.
//!
//! On the CPU a core plays one part through a whole rollout. If all parts went step by step together, at
//! every step cores would wait for the slowest. On a GPU all environments are one part.

use super::curriculum::Curriculum;
use super::live_view::LiveView;
use super::spec::EnvSpec;
use super::stats::Stats;
use super::vec_env::VecEnv;
use crate::container::{Section, SectionError};
use crate::gpu::{Array, Device};
use crate::ranks::Ranks;
use anyhow::Result;
use std::ops::Range;

/// Parts on the CPU. Not one for every core, for what is summed over parts must not depend on the
/// number of cores; where there are more, they share in the searches of a part.
const PARTS: usize = 4;

/// How the names of the sections of a batch's parts begin; the part's number follows.
pub const ENVS: &str = "envs.";

/// The environments of a training; of one on several ranks, this rank's.
pub struct EnvBatch {
    /// Parts that together are the batch, in the order of their environments.
    pub parts: Vec<Box<dyn VecEnv>>,
    /// How the difficulty rises, if it does.
    pub curriculum: Option<Curriculum>,
    /// Who trains with this process.
    pub ranks: Ranks,
    /// Number of the first of these environments, and of the first part, among those of all ranks.
    first: [usize; 2],
}

impl EnvBatch {
    /// This rank's share of `envs` environments, opened in parts: `open` is given the numbers of a part's environments.
    ///
    /// # Errors
    /// Those of `open`.
    pub fn open(
        device: &Device,
        ranks: &Ranks,
        envs: usize,
        curriculum: Option<Curriculum>,
        open: impl Fn(Range<usize>) -> Result<Box<dyn VecEnv>>,
    ) -> Result<Self> {
        let least = match device {
            Device::Cpu => PARTS.min(envs).max(1),
            Device::Gpu(_) => 1,
        };
        // As many on every rank.
        let all = least.next_multiple_of(ranks.count());
        let share = ranks.share(all);
        let first = [envs * share.start / all, share.start];
        let ranges = share.map(|part| envs * part / all..envs * (part + 1) / all);
        let parts = ranges.map(open).collect::<Result<Vec<_>>>()?;
        let mut batch = EnvBatch {
            ranks: ranks.clone(),
            first,
            ..Self::new(parts, curriculum)
        };
        batch.set_level();
        Ok(batch)
    }

    /// Environments of a process that trains alone.
    pub fn new(parts: Vec<Box<dyn VecEnv>>, curriculum: Option<Curriculum>) -> Self {
        EnvBatch {
            parts,
            curriculum,
            ranks: Ranks::alone(),
            first: [0, 0],
        }
    }

    /// Number of the first row among those of all ranks.
    pub fn first_row(&self) -> usize {
        self.first[0] * self.spec().agents
    }

    /// The dimensions of these environments together.
    pub fn spec(&self) -> EnvSpec {
        let envs = self.parts.iter().map(|part| part.spec().envs).sum();
        EnvSpec {
            envs,
            ..*self.parts[0].spec()
        }
    }

    /// An action that keeps an agent as it is: see [`VecEnv::rest_action`].
    pub fn rest_action(&self) -> Vec<f32> {
        self.parts[0].rest_action()
    }

    /// Names of what [`EnvBatch::stats`] writes.
    pub fn stat_names(&self) -> &'static [&'static str] {
        self.parts[0].stat_names()
    }

    /// Writes the sums over all parts: see [`VecEnv::stats`].
    pub fn stats(&mut self, out: &mut Array) {
        let (first, rest) = self.parts.split_at_mut(1);
        first[0].stats(out);
        for part in rest {
            let mut more = Array::Host(vec![0.0; out.len()]);
            part.stats(&mut more);
            let sums = out.host_mut().iter_mut().zip(more.host());
            sums.for_each(|(sum, more)| *sum += more);
        }
    }

    /// Takes an update's statistics in, and raises the level where that is due.
    pub fn advance_curriculum(&mut self, stats: &Stats) {
        let envs = self.spec().envs * self.ranks.count();
        if let Some(curriculum) = &mut self.curriculum
            && curriculum.advance(stats, envs)
        {
            self.set_level();
        }
    }

    fn set_level(&mut self) {
        if let Some(curriculum) = &self.curriculum {
            let level = curriculum.level();
            self.parts.iter_mut().for_each(|part| part.set_level(level));
        }
    }

    /// What there is to see of all parts: see [`VecEnv::live_view`].
    ///
    /// # Errors
    /// The device was lost.
    pub fn live_view(&mut self) -> Result<Option<LiveView>> {
        let mut all: Option<LiveView> = None;
        for part in &mut self.parts {
            match (&mut all, part.live_view()?) {
                (Some(all), Some(part)) => all.join(part),
                (_, first) => all = first,
            }
        }
        Ok(all)
    }

    /// Contacts that found no room, in all parts: see [`VecEnv::contact_overflow`].
    ///
    /// # Errors
    /// The device was lost.
    pub fn contact_overflow(&self) -> Result<u64> {
        self.parts.iter().map(|part| part.contact_overflow()).sum()
    }

    /// Saves every part into a section of its own, and the curriculum.
    ///
    /// # Errors
    /// The device was lost.
    pub fn save(&self) -> Result<Vec<(String, Section)>> {
        let mut sections = Vec::new();
        for (number, part) in (self.first[1]..).zip(&self.parts) {
            let mut section = Section::default();
            part.save(&mut section)?;
            sections.push((format!("{ENVS}{number}"), section));
        }
        if let Some(curriculum) = &self.curriculum {
            let mut section = Section::default();
            section.put("curriculum", curriculum);
            sections.push(("curriculum".to_string(), section));
        }
        Ok(sections)
    }

    /// Puts back what [`EnvBatch::save`] wrote; `section` finds a section by name.
    ///
    /// # Errors
    /// A section is missing, or not of such environments.
    pub fn load(
        &mut self,
        mut section: impl FnMut(&str) -> Result<Section, SectionError>,
    ) -> Result<(), SectionError> {
        for (number, part) in (self.first[1]..).zip(&mut self.parts) {
            part.load(&mut section(&format!("{ENVS}{number}"))?)?;
        }
        self.load_level(section)
    }

    /// Puts back the level that [`EnvBatch::save`] wrote, of environments that begin new episodes.
    ///
    /// # Errors
    /// As there.
    pub fn load_level(
        &mut self,
        mut section: impl FnMut(&str) -> Result<Section, SectionError>,
    ) -> Result<(), SectionError> {
        if self.curriculum.is_some() {
            self.curriculum = Some(section("curriculum")?.get("curriculum")?);
        }
        self.set_level();
        Ok(())
    }
}
