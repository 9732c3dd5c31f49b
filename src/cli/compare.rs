//! `footwork compare`.

use super::Usage;
use super::opened::{Opened, Shared};
use super::setting::Settings;
use super::train::{Choices, on_interrupt};
use super::trainings::Trainings;
use anyhow::Result;
use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser};
use footwork::ranks::Ranks;
use footwork::rl::ase::STEPS_PER_DECISION;
use footwork::train::comparison::{Comparison, Contestant};
use footwork::train::config::Config;
use footwork::train::task::TaskEntry;
use footwork::train::tasks::{REGISTRY, find};
use std::collections::BTreeMap;
use std::path::PathBuf;

#[derive(Args)]
pub struct Compare {
    /// The task
    #[arg(value_parser = names())]
    what: String,
    #[command(flatten)]
    choices: Choices,
    #[command(flatten)]
    settings: Settings,
    #[command(flatten)]
    trainings: Trainings,
    /// Folder of all its runs; given again, it goes on where it was [default: runs/compare-TASK]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

fn names() -> PossibleValuesParser {
    let tasks = REGISTRY.iter().filter(|entry| entry.steering.is_some());
    PossibleValuesParser::new(tasks.map(|entry| PossibleValue::new(entry.name).help(entry.about)))
}

impl Compare {
    pub fn run(self, ranks: &Ranks) -> Result<()> {
        self.trainings.check()?;
        let entry = find(&self.what)?;
        let Some(steering) = &entry.steering else {
            return Err(Usage(format!("`{}` steers no low level", entry.name)).into());
        };
        let interrupted = on_interrupt()?;
        let start = self.choices.start()?;
        let [direct, steered] = self.open(entry, ranks)?;
        let out = format!("runs/compare-{}", entry.name).into();
        let out = self.out.unwrap_or(out);
        let comparison = Comparison {
            title: "comparison",
            entry,
            contestants: vec![
                Contestant {
                    name: "direct".to_string(),
                    settings: BTreeMap::new(),
                    config: direct.config,
                    task: direct.task,
                    start: start.as_ref(),
                    body_steps: 1,
                },
                Contestant {
                    name: "steered".to_string(),
                    settings: skills(&steered.config),
                    config: steered.config,
                    task: steered.task,
                    start: None,
                    body_steps: STEPS_PER_DECISION as u64,
                },
            ],
            seeds: self.trainings.seeds,
            measures: steering.measures,
            rates: steering.rates,
            device: &direct.device,
            ranks,
            out: &out,
        };
        self.trainings.run(&comparison, interrupted)
    }

    /// The training of a policy that acts itself, and on the same device that of one which steers the low level: as many
    /// steps of the body.
    fn open(&self, entry: &TaskEntry, ranks: &Ranks) -> Result<[Opened; 2]> {
        if self.choices.skills.is_none() {
            let why = "--skills RUN names the low level that is to be compared with none";
            return Err(Usage(why.into()).into());
        }
        let mut acting = self.choices.clone();
        acting.skills = None;
        let (settings, trainings) = (&self.settings.all, Shared::Trainings);
        let configure = |envs| acting.config(entry, envs, settings);
        let direct = acting.open(entry, ranks, trainings, &configure)?;
        let mut steering = self.choices.clone();
        steering.device = Some(direct.config.device);
        let steered = steering.open(entry, ranks, trainings, &|envs| {
            let mut config = steering.config(entry, envs, settings)?;
            config.steps = direct.config.steps.div_ceil(STEPS_PER_DECISION as u64);
            Ok(config)
        })?;
        Ok([direct, steered])
    }
}

/// The key by which a policy that steers is another.
fn skills(steered: &Config) -> BTreeMap<String, toml::Value> {
    let skills = steered.skills.iter();
    let value = |skills: &PathBuf| skills.display().to_string().into();
    skills
        .map(|skills| ("skills".to_string(), value(skills)))
        .collect()
}
