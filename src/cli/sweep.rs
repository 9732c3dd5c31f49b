//! `footwork sweep`.

use super::Usage;
use super::grid::{SweptKey, combinations, name, swept_key};
use super::opened::{Opened, Shared};
use super::setting::Setting;
use super::train::{Choices, names, on_interrupt};
use super::trainings::Trainings;
use anyhow::Result;
use clap::Args;
use footwork::ranks::Ranks;
use footwork::train::checkpoint::Checkpoint;
use footwork::train::comparison::{Comparison, Contestant, folder_name};
use footwork::train::config::Config;
use footwork::train::task::{Task, TaskEntry};
use footwork::train::tasks::find;
use std::collections::BTreeSet;
use std::path::PathBuf;

/// Trainings of the largest sweep.
const MAX_TRAININGS: usize = 1000;
/// Keys and tables that all trainings of a sweep share: they decide over the device and the data.
const SHARED: [&str; 7] = [
    "data",
    "data_folder",
    "device",
    "ground",
    "roles",
    "task.weights",
    "unit_m",
];

#[derive(Args)]
pub struct Sweep {
    /// What to learn
    #[arg(value_parser = names())]
    task: String,
    #[command(flatten)]
    choices: Choices,
    /// A key with the values to try, like ppo.gamma=0.97,0.99 or ppo.network.hidden=[64,64],[128]; of several
    /// keys every combination
    #[arg(long, value_name = "KEY=A,B,..", value_parser = swept_key)]
    set: Vec<SweptKey>,
    #[command(flatten)]
    trainings: Trainings,
    /// Folder of all its runs; given again, it goes on where it was [default: runs/TASK-sweep]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

impl Sweep {
    pub fn run(self, ranks: &Ranks) -> Result<()> {
        self.trainings.check()?;
        self.check_keys()?;
        let entry = find(&self.task)?;
        let interrupted = on_interrupt()?;
        let (fixed, swept): (Vec<SweptKey>, Vec<SweptKey>) =
            self.set.into_iter().partition(|key| key.values.len() == 1);
        let points = combinations(&swept);
        let (choices, fixed) = (&self.choices, &combinations(&fixed)[0]);
        let base = choices.config(entry, None, fixed)?;
        // Before the data is loaded, which may take its time.
        for point in &points {
            entry.check(&with_settings(&base, point)?)?;
        }
        let start = choices.start()?;
        let configure = |envs| with_settings(&choices.config(entry, envs, fixed)?, &points[0]);
        let Opened {
            config: base,
            device,
            task,
            ..
        } = choices.open(entry, ranks, Shared::Trainings, &configure)?;
        let out = format!("runs/{}-sweep", entry.name).into();
        let comparison = Comparison {
            title: "sweep",
            entry,
            contestants: contestants(entry, &points, &base, &*task, start.as_ref())?,
            seeds: self.trainings.seeds,
            measures: &[],
            rates: &[],
            device: &device,
            ranks,
            out: &self.out.unwrap_or(out),
        };
        comparison.refuse_strangers()?;
        self.trainings.run(&comparison, interrupted)
    }

    /// Refuses keys that cannot be swept, or not so often.
    fn check_keys(&self) -> Result<(), Usage> {
        let mut seen = BTreeSet::new();
        for SweptKey { key, values } in &self.set {
            if !seen.insert(key) {
                return Err(Usage(format!(
                    "--set {key} is given twice: give all its values at once, separated by commas"
                )));
            }
            if key == "seed" {
                let why =
                    "--set seed: a sweep trains from the seeds 1, 2, ..; --seeds says how many";
                return Err(Usage(why.into()));
            }
            if key == "ppo.envs" && self.choices.grows() {
                let why = "--set ppo.envs and --envs auto: give one of them";
                return Err(Usage(why.into()));
            }
            if values.len() > 1 && is_shared(key) {
                return Err(Usage(format!(
                    "--set {key}: all trainings of a sweep share it; give one value"
                )));
            }
        }
        let counts = self.set.iter().map(|key| key.values.len());
        let trainings = counts.fold(self.trainings.seeds as usize, usize::saturating_mul);
        if trainings > MAX_TRAININGS {
            return Err(Usage(format!(
                "these are {trainings} trainings, and a sweep has at most {MAX_TRAININGS}: give fewer values or --seeds"
            )));
        }
        Ok(())
    }
}

fn is_shared(key: &str) -> bool {
    SHARED.iter().any(|shared| {
        let rest = key.strip_prefix(shared);
        rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
    })
}

/// A configuration with some keys changed.
fn with_settings(base: &Config, settings: &[Setting]) -> Result<Config> {
    let mut config = base.clone();
    for Setting { key, value } in settings {
        config.set(key, value.clone())?;
    }
    Ok(config)
}

/// A contestant for every point of the grid.
fn contestants<'a>(
    entry: &TaskEntry,
    points: &[Vec<Setting>],
    base: &Config,
    task: &dyn Task,
    start: Option<&'a Checkpoint>,
) -> Result<Vec<Contestant<'a>>> {
    let contestant = |point: &Vec<Setting>| {
        let mut config = with_settings(base, point)?;
        let task = task.with_choices(&config)?;
        config.task.settings = task.settings();
        let settings = point.iter().cloned();
        let name = match &point[..] {
            [] => entry.name.to_string(),
            _ => name(point),
        };
        Ok(Contestant {
            name,
            settings: settings
                .map(|setting| (setting.key, setting.value))
                .collect(),
            config,
            task,
            start,
            body_steps: 1,
        })
    };
    let all: Vec<Contestant> = points.iter().map(contestant).collect::<Result<_>>()?;
    refuse_equals(&all)?;
    Ok(all)
}

/// Refuses points that come to the same.
fn refuse_equals(contestants: &[Contestant]) -> Result<(), Usage> {
    for (index, one) in contestants.iter().enumerate() {
        let same = |other: &&Contestant| {
            other.config == one.config || folder_name(&other.name) == folder_name(&one.name)
        };
        if let Some(other) = contestants[..index].iter().find(same) {
            return Err(Usage(format!(
                "`{}` and `{}` come to the same: leave one out",
                other.name, one.name
            )));
        }
    }
    Ok(())
}
