//! `footwork ablate`.

use super::Usage;
use super::opened::Opened;
use super::progress::Progress;
use super::say::{say, show};
use super::train::{Choices, on_interrupt};
use anyhow::Result;
use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser};
use footwork::train::checkpoint::Checkpoint;
use footwork::train::comparison::{Comparison, Contestant, Outcome};
use footwork::train::config::Config;
use footwork::train::task::{Ablation, Task, TaskEntry};
use footwork::train::tasks::REGISTRY;
use std::path::PathBuf;

#[derive(Args)]
pub struct Ablate {
    /// What to compare
    #[arg(value_parser = names())]
    what: String,
    #[command(flatten)]
    choices: Choices,
    /// Trainings of each variant, from the seeds 1, 2, ..
    #[arg(
        long,
        default_value_t = 3,
        value_name = "N",
        allow_negative_numbers = true
    )]
    seeds: u32,
    /// Folder of all its runs; given again, it goes on where it was [default: runs/WHAT]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Every ablation with the task it is of.
fn all() -> impl Iterator<Item = (&'static TaskEntry, &'static Ablation)> {
    let tasks = REGISTRY.iter();
    tasks.flat_map(|entry| {
        entry
            .ablations
            .iter()
            .map(move |ablation| (entry, ablation))
    })
}

fn names() -> PossibleValuesParser {
    let names = all().map(|(_, ablation)| PossibleValue::new(ablation.name).help(ablation.about));
    PossibleValuesParser::new(names)
}

impl Ablate {
    pub fn run(self) -> Result<()> {
        if self.seeds == 0 || self.seeds > 100 {
            return Err(Usage("--seeds must be from 1 to 100".into()).into());
        }
        let found = all().find(|(_, ablation)| ablation.name == self.what);
        let Some((entry, ablation)) = found else {
            return Err(Usage(format!("there is no ablation `{}`", self.what)).into());
        };
        let interrupted = on_interrupt()?;
        let choices = &self.choices;
        let opened = choices.open(entry, &|envs| choices.config(entry, envs))?;
        let Opened {
            config,
            device,
            task,
            ..
        } = opened;
        let out = self.out.unwrap_or_else(|| ablation.folder.into());
        let start = self.choices.start()?;
        let comparison = Comparison {
            title: "ablation",
            entry,
            contestants: contestants(ablation, &config, &*task, start.as_ref())?,
            measures: ablation.measures,
            rates: ablation.rates,
            device: &device,
            out: &out,
        };
        let mut progress = Progress::new(&config);
        let outcomes = comparison.run(self.seeds, interrupted, &mut progress)?;
        drop(progress);
        report_outcomes(&comparison, outcomes.as_deref());
        Ok(())
    }
}

/// The variants of an ablation, with what they share.
fn contestants<'a>(
    ablation: &Ablation,
    base: &Config,
    task: &dyn Task,
    start: Option<&'a Checkpoint>,
) -> Result<Vec<Contestant<'a>>> {
    let variants = ablation.variants.iter();
    let contestant = variants.map(|variant| {
        let mut config = base.clone();
        config.task.settings.extend((variant.changes)());
        Ok(Contestant {
            name: variant.name,
            task: task.with_choices(&config)?,
            config,
            start,
            body_steps: 1,
        })
    });
    contestant.collect()
}

/// Says what came of a comparison.
pub fn report_outcomes(comparison: &Comparison, outcomes: Option<&[Outcome]>) {
    match outcomes {
        Some(outcomes) => show!("{}", comparison.summary(outcomes)),
        None => say!("go on with the same command"),
    }
    say!("see {}", comparison.out.display());
}
