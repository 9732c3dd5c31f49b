//! `footwork compare`.

use super::Usage;
use super::ablate::report_outcomes;
use super::opened::Opened;
use super::progress::Progress;
use super::train::{Choices, on_interrupt};
use anyhow::Result;
use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser};
use footwork::rl::ase::STEPS_PER_DECISION;
use footwork::train::comparison::{Comparison, Contestant};
use footwork::train::task::TaskEntry;
use footwork::train::tasks::{REGISTRY, find};
use std::path::PathBuf;

#[derive(Args)]
pub struct Compare {
    /// The task
    #[arg(value_parser = names())]
    what: String,
    #[command(flatten)]
    choices: Choices,
    /// Trainings of each, from the seeds 1, 2, ..
    #[arg(
        long,
        default_value_t = 3,
        value_name = "N",
        allow_negative_numbers = true
    )]
    seeds: u32,
    /// Folder of all its runs; given again, it goes on where it was [default: runs/compare-TASK]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

fn names() -> PossibleValuesParser {
    let tasks = REGISTRY.iter().filter(|entry| entry.steering.is_some());
    PossibleValuesParser::new(tasks.map(|entry| PossibleValue::new(entry.name).help(entry.about)))
}

impl Compare {
    pub fn run(self) -> Result<()> {
        if self.seeds == 0 || self.seeds > 100 {
            return Err(Usage("--seeds must be from 1 to 100".into()).into());
        }
        let entry = find(&self.what)?;
        let Some(steering) = &entry.steering else {
            return Err(Usage(format!("`{}` steers no low level", entry.name)).into());
        };
        let interrupted = on_interrupt()?;
        let start = self.choices.start()?;
        let [direct, steered] = self.open(entry)?;
        let out = format!("runs/compare-{}", entry.name).into();
        let out = self.out.unwrap_or(out);
        let mut progress = Progress::new(&direct.config);
        let comparison = Comparison {
            title: "comparison",
            entry,
            contestants: vec![
                Contestant {
                    name: "direct",
                    config: direct.config,
                    task: direct.task,
                    start: start.as_ref(),
                    body_steps: 1,
                },
                Contestant {
                    name: "steered",
                    config: steered.config,
                    task: steered.task,
                    start: None,
                    body_steps: STEPS_PER_DECISION as u64,
                },
            ],
            measures: steering.measures,
            rates: steering.rates,
            device: &direct.device,
            out: &out,
        };
        let outcomes = comparison.run(self.seeds, interrupted, &mut progress)?;
        drop(progress);
        report_outcomes(&comparison, outcomes.as_deref());
        Ok(())
    }

    /// The training of a policy that acts itself, and on the same device that of one which steers the low level: as many
    /// steps of the body.
    fn open(&self, entry: &TaskEntry) -> Result<[Opened; 2]> {
        if self.choices.skills.is_none() {
            let why = "--skills RUN names the low level that is to be compared with none";
            return Err(Usage(why.into()).into());
        }
        let mut acting = self.choices.clone();
        acting.skills = None;
        let direct = acting.open(entry, &|envs| acting.config(entry, envs))?;
        let mut steering = self.choices.clone();
        steering.device = Some(direct.config.device);
        let steered = steering.open(entry, &|envs| {
            let mut config = steering.config(entry, envs)?;
            config.steps = direct.config.steps.div_ceil(STEPS_PER_DECISION as u64);
            Ok(config)
        })?;
        Ok([direct, steered])
    }
}
