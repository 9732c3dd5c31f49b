//! `footwork tournament`.

use super::Usage;
use super::run::{Moved, MovedFiles, Run};
use super::say::{say, show, tell};
#[cfg(feature = "report")]
use super::usage::writable;
use anyhow::Result;
use clap::Args;
use footwork::train::run_dir::RunDir;
use footwork::train::tournament::{Bouts, TournamentPlayer, play};
use std::path::{Path, PathBuf};

#[derive(Args)]
pub struct Tournament {
    /// Runs of `box`, whose last checkpoints fight, or single checkpoints; the rules are those of the first
    #[arg(required_unless_present = "checkpoints", value_name = "RUN")]
    players: Vec<PathBuf>,
    /// Let all checkpoints of a run fight, but for the best, which is one of them; may be given several times
    #[arg(long, value_name = "RUN")]
    checkpoints: Vec<PathBuf>,
    #[command(flatten)]
    files: MovedFiles,
    /// Bouts between any two, half of them in either corner
    #[arg(
        long,
        default_value_t = 200,
        value_name = "N",
        allow_negative_numbers = true
    )]
    bouts: usize,
    /// Draw who beats whom as a PNG
    #[cfg(feature = "report")]
    #[arg(long, value_name = "FILE.png")]
    plot: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// Those who fight, and what they fight in.
#[derive(Default)]
struct Field {
    bouts: Option<Bouts>,
    players: Vec<TournamentPlayer>,
}

impl Tournament {
    pub fn run(self) -> Result<()> {
        if !(2..=100_000).contains(&self.bouts) || !self.bouts.is_multiple_of(2) {
            return Err(Usage("--bouts must be an even number from 2 to 100000".into()).into());
        }
        let mut field = Field::default();
        #[cfg(feature = "report")]
        if let Some(path) = &self.plot {
            drawable(path)?;
        }
        let moved = self.files.moved();
        for run in &self.players {
            field.enter(run, moved, false)?;
        }
        for run in &self.checkpoints {
            field.enter(run, moved, true)?;
        }
        let (Some(Bouts { task, anchors }), 2..) = (field.bouts, field.players.len()) else {
            let why = "a tournament takes two checkpoints at least: name more runs, or give --checkpoints";
            return Err(Usage(why.into()).into());
        };
        field.players.extend(anchors);
        let count = field.players.len();
        tell!(
            "{count} players, {} bouts",
            count * (count - 1) / 2 * self.bouts
        );
        let found = play(&task, &field.players, self.bouts / 2);
        match self.json {
            true => say!("{}", serde_json::to_string(&found)?),
            false => show!("{}", found.summary()),
        }
        #[cfg(feature = "report")]
        if let Some(path) = &self.plot {
            draw(path, &found)?;
        }
        Ok(())
    }
}

impl Field {
    /// Lets a run's last checkpoint or a given one fight, or all of the run's.
    fn enter(&mut self, path: &Path, moved: Moved, all: bool) -> Result<()> {
        let run = Run::open(path, moved)?;
        let Some(bouts) = run.task.bouts() else {
            let (path, task) = (path.display(), &run.config.task.name);
            let why = format!("{path} is a run of `{task}`, in which nobody fights");
            return Err(Usage(why).into());
        };
        let mut files = vec![run.path.clone()];
        if all {
            files = RunDir::open(path)?.checkpoint_files()?;
            files.retain(|file| file.file_stem().is_none_or(|stem| stem != "best"));
        }
        for file in files {
            let policy = run.checkpoint(&file)?.policy;
            self.players.push(TournamentPlayer {
                name: name(&file),
                driver: run.task.driver(&policy),
            });
        }
        self.bouts.get_or_insert(bouts);
        Ok(())
    }
}

/// The run's folder and the checkpoint.
fn name(checkpoint: &Path) -> String {
    let whole = std::path::absolute(checkpoint).unwrap_or_else(|_| checkpoint.to_path_buf());
    let run = whole.ancestors().nth(2).and_then(Path::file_name);
    let names = [run, whole.file_stem()].map(|name| name.unwrap_or_default().to_string_lossy());
    names.join("/")
}

/// Refuses a picture that could not be written, before anybody fights.
#[cfg(feature = "report")]
fn drawable(path: &Path) -> Result<()> {
    if path.extension().is_none_or(|ending| ending != "png") {
        return Err(Usage("--plot must end in .png".into()).into());
    }
    writable(path)
}

#[cfg(feature = "report")]
fn draw(path: &Path, found: &footwork::train::tournament::TournamentReport) -> Result<()> {
    let names: Vec<String> = found
        .players
        .iter()
        .map(|player| player.name.clone())
        .collect();
    let row = |one: usize| {
        (0..names.len())
            .map(|other| found.win_rate(one, other))
            .collect()
    };
    let rates: Vec<Vec<Option<f64>>> = (0..names.len()).map(row).collect();
    footwork::report::win_rates::draw(path, &names, &rates)?;
    tell!("{}", path.display());
    Ok(())
}
