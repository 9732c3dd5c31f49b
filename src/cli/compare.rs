//! `footwork compare`.

use super::Usage;
use super::ablate::report_outcomes;
use super::progress::Progress;
use super::train::{Choices, Opened, on_interrupt};
use anyhow::Result;
use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser};
use footwork::ranks::Ranks;
use footwork::rl::ase::STEPS_PER_DECISION;
use footwork::train::comparison::{Comparison, Contestant};
use footwork::train::config::Config;
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
        let [mut acting, mut steered] = self.configurations(entry)?;
        let [direct, high] = [
            Opened::new(entry, &mut acting, &Ranks::alone())?,
            Opened::new(entry, &mut steered, &Ranks::alone())?,
        ];
        let out = format!("runs/compare-{}", entry.name).into();
        let out = self.out.unwrap_or(out);
        let mut progress = Progress::new(&acting);
        let comparison = Comparison {
            title: "comparison",
            entry,
            contestants: vec![
                Contestant {
                    name: "direct",
                    config: acting,
                    task: direct.task,
                    start: start.as_ref(),
                    body_steps: 1,
                },
                Contestant {
                    name: "steered",
                    config: steered,
                    task: high.task,
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

    /// The choices of a policy that acts itself, and of one that steers the low level: as many steps of the body.
    fn configurations(&self, entry: &TaskEntry) -> Result<[Config; 2]> {
        if self.choices.skills.is_none() {
            let why = "--skills RUN names the low level that is to be compared with none";
            return Err(Usage(why.into()).into());
        }
        let mut acting = self.choices.clone();
        acting.skills = None;
        let acting = acting.config(entry)?;
        let mut steering = self.choices.config(entry)?;
        steering.steps = acting.steps.div_ceil(STEPS_PER_DECISION as u64);
        Ok([acting, steering])
    }
}
