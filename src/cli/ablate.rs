//! `footwork ablate`.

use super::Usage;
use super::opened::{Opened, Shared};
use super::setting::Settings;
use super::train::{Choices, on_interrupt};
use super::trainings::Trainings;
use anyhow::Result;
use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser};
use footwork::ranks::Ranks;
use footwork::train::checkpoint::Checkpoint;
use footwork::train::comparison::{Comparison, Contestant};
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
    #[command(flatten)]
    settings: Settings,
    #[command(flatten)]
    trainings: Trainings,
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
    pub fn run(self, ranks: &Ranks) -> Result<()> {
        self.trainings.check()?;
        let found = all().find(|(_, ablation)| ablation.name == self.what);
        let Some((entry, ablation)) = found else {
            return Err(Usage(format!("there is no ablation `{}`", self.what)).into());
        };
        let interrupted = on_interrupt()?;
        let (choices, settings) = (&self.choices, &self.settings.all);
        let configure = |envs| choices.config(entry, envs, settings);
        let Opened {
            config,
            device,
            task,
            ..
        } = choices.open(entry, ranks, Shared::Trainings, &configure)?;
        let out = self.out.unwrap_or_else(|| ablation.folder.into());
        let start = self.choices.start()?;
        let comparison = Comparison {
            title: "ablation",
            entry,
            contestants: contestants(ablation, &config, &*task, start.as_ref())?,
            seeds: self.trainings.seeds,
            measures: ablation.measures,
            rates: ablation.rates,
            device: &device,
            ranks,
            out: &out,
        };
        self.trainings.run(&comparison, interrupted)
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
        let changes = (variant.changes)();
        config.task.settings.extend(changes.clone());
        let key = |(name, value)| (format!("task.{name}"), value);
        Ok(Contestant {
            name: variant.name.to_string(),
            settings: changes.into_iter().map(key).collect(),
            task: task.with_choices(&config)?,
            config,
            start,
            body_steps: 1,
        })
    });
    contestant.collect()
}
