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
use anyhow::Result;
use std::ops::Range;

/// Parts on the CPU. Not one for every core, for what is summed over parts must not depend on the
/// number of cores; where there are more, they share in the searches of a part.
const PARTS: usize = 4;

/// All environments of a training.
pub struct EnvBatch {
    /// Parts that together are the batch, in the order of their environments.
    pub parts: Vec<Box<dyn VecEnv>>,
    /// How the difficulty rises, if it does.
    pub curriculum: Option<Curriculum>,
}

impl EnvBatch {
    /// `envs` environments, opened in parts: `open` is given the numbers of a part's environments.
    ///
    /// # Errors
    /// Those of `open`.
    pub fn open(
        device: &Device,
        envs: usize,
        curriculum: Option<Curriculum>,
        open: impl Fn(Range<usize>) -> Result<Box<dyn VecEnv>>,
    ) -> Result<Self> {
        let parts = match device {
            Device::Cpu => PARTS.min(envs).max(1),
            Device::Gpu(_) => 1,
        };
        let ranges = (0..parts).map(|part| envs * part / parts..envs * (part + 1) / parts);
        let parts = ranges.map(open).collect::<Result<Vec<_>>>()?;
        let mut batch = EnvBatch { parts, curriculum };
        batch.set_level();
        Ok(batch)
    }

    /// The dimensions of all environments together.
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
        let envs = self.spec().envs;
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
        for (number, part) in self.parts.iter().enumerate() {
            let mut section = Section::default();
            part.save(&mut section)?;
            sections.push((format!("envs.{number}"), section));
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
        for (number, part) in self.parts.iter_mut().enumerate() {
            part.load(&mut section(&format!("envs.{number}"))?)?;
        }
        if self.curriculum.is_some() {
            self.curriculum = Some(section("curriculum")?.get("curriculum")?);
        }
        self.set_level();
        Ok(())
    }
}
