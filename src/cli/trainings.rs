//! Trainings side by side, as `ablate`, `compare` and `sweep` do them.

use super::Usage;
use super::progress::Progress;
use super::say::{say, show};
use anyhow::{Result, bail};
use clap::Args;
use footwork::gpu::Device;
use footwork::train::agreement;
use footwork::train::comparison::{Comparison, Contestant};
use footwork::train::memory;
use std::sync::atomic::AtomicBool;

#[derive(Args)]
pub struct Trainings {
    /// Trainings of each variant, from the seeds 1, 2, ..
    #[arg(
        long,
        default_value_t = 3,
        value_name = "N",
        allow_negative_numbers = true
    )]
    pub seeds: u32,
    /// Trainings at once, each with its share of the processor's threads
    #[arg(
        long,
        default_value_t = 1,
        value_name = "N",
        allow_negative_numbers = true
    )]
    pub jobs: usize,
}

impl Trainings {
    /// Refuses numbers that make no sense.
    pub fn check(&self) -> Result<(), Usage> {
        if self.seeds == 0 || self.seeds > 100 {
            return Err(Usage("--seeds must be from 1 to 100".into()));
        }
        if self.jobs == 0 {
            return Err(Usage("--jobs must be at least 1".into()));
        }
        Ok(())
    }

    /// Does the trainings and says what came of them.
    pub fn run(&self, comparison: &Comparison, interrupted: &AtomicBool) -> Result<()> {
        let jobs = self.jobs.min(comparison.runs().len());
        check_memory(comparison, jobs)?;
        for Contestant {
            config,
            task,
            start,
            ..
        } in &comparison.contestants
        {
            agreement::check(comparison.ranks, config, &**task, *start)?;
        }
        let mut progress = Progress::several(jobs);
        let outcomes = comparison.run(interrupted, &mut progress)?;
        drop(progress);
        if !comparison.ranks.is_first() {
            return Ok(());
        }
        let out = comparison.out.display();
        let Some(outcomes) = outcomes else {
            say!("go on with the same command");
            say!("see {out}");
            return Ok(());
        };
        show!("{}", comparison.summary(&outcomes));
        say!("see {out}");
        let failed = outcomes.iter().filter(|outcome| outcome.result.is_err());
        match failed.count() {
            0 => Ok(()),
            failed => bail!(
                "{failed} of {} trainings failed: the same command tries them again",
                outcomes.len()
            ),
        }
    }
}

/// Refuses more trainings at once than the memory holds.
fn check_memory(comparison: &Comparison, jobs: usize) -> Result<()> {
    if !matches!(comparison.device, Device::Cpu) {
        return Ok(());
    }
    let mut largest = 0;
    for contestant in &comparison.contestants {
        let spec = comparison.entry.check(&contestant.config)?;
        largest = largest.max(memory::of_training(&spec, &contestant.config));
    }
    let advice = "use fewer --jobs, a smaller --envs or ppo.rollout_length";
    memory::check(jobs as u64 * largest, advice)
}
