//! `footwork play`.

use super::run::{locate, motion};
use anyhow::Result;
use clap::Args;
use footwork::gpu::Gpu;
use footwork::motion::normalise::Weights;
use footwork::viewer::app::Choice;
use footwork::viewer::window;
use footwork::playback::player::Style;
use footwork::train::checkpoint::Checkpoint;
use footwork::train::controller::Trained;
use footwork::train::data;
use footwork::view::playthrough::PlaythroughContext;
use footwork::env::locomotion::{Plane, Task};
use std::path::PathBuf;
use std::sync::Arc;

#[derive(Args)]
pub struct Play {
    /// A run's folder, or one of its checkpoints; without it, motion alone is looked at
    #[arg(required_unless_present = "data")]
    run: Option<PathBuf>,
    /// Motion to browse and to steer by hand; with RUN, where the run's motion is now
    #[arg(long, value_name = "DIR|FILE")]
    data: Option<PathBuf>,
}

impl Play {
    pub fn run(self) -> Result<()> {
        match &self.run {
            Some(run) => self.policy(run),
            None => self.motion(),
        }
    }

    fn policy(&self, run: &std::path::Path) -> Result<()> {
        let (folder, path) = locate(run)?;
        let config = folder.read_config()?;
        let database = motion(&config, self.data.as_deref())?;
        let checkpoint = Checkpoint::load_for(&path, &config.task, database.fingerprint)?;
        let task = checkpoint.header.task;
        let mut paths = folder.checkpoint_files()?;
        // The requested one is shown first: it comes last.
        paths.retain(|other| other.file_name() != path.file_name());
        paths.push(path);
        let choices = paths.into_iter().map(|path| {
            let (task, database) = (config.task, database.fingerprint);
            Choice {
                name: path
                    .file_stem()
                    .unwrap_or_default()
                    .to_string_lossy()
                    .into(),
                load: Box::new(move || {
                    let checkpoint = Checkpoint::load_for(&path, &task, database)?;
                    Ok(Box::new(Trained::from(&checkpoint)))
                }),
            }
        });
        let title = format!("footwork: {}", folder.path().display());
        let context = PlaythroughContext::new(database.clone(), task, Style::BEST);
        window::play(&Gpu::drawing()?, &title, context, choices.collect())
    }

    fn motion(&self) -> Result<()> {
        let (database, notes) = data::load(self.data.as_deref(), Weights::PAPER)?;
        for note in notes {
            eprintln!("note: {note}");
        }
        // Steered by hand, the character never arrives.
        let task = Task::Plane(Plane {
            reach: 0.0,
            ..Plane::default()
        });
        let context = PlaythroughContext::new(Arc::new(database), task, Style::BEST);
        window::play(&Gpu::drawing()?, "footwork", context, Vec::new())
    }
}
