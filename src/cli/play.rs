//! `footwork play`.

use super::run::Run;
use super::say::tell;
use anyhow::Result;
use clap::Args;
use footwork::env::locomotion::{LocomotionTask, Plane};
use footwork::gpu::Gpu;
use footwork::motion::normalise::Weights;
use footwork::playback::player::Style;
use footwork::train::controller::Controller;
use footwork::train::data;
use footwork::view::playthrough::PlaythroughContext;
use footwork::viewer::app::PolicyEntry;
use footwork::viewer::window;
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
        let run = Run::open(run, self.data.as_deref())?;
        let locomotion = run.locomotion("play")?;
        let (matcher, task) = (locomotion.matcher.clone(), locomotion.task);
        run.checkpoint(&run.path)?;
        let mut paths = run.folder.checkpoint_files()?;
        // The requested one is shown first: it comes last.
        paths.retain(|other| other.file_name() != run.path.file_name());
        paths.push(run.path.clone());
        let run = Arc::new(run);
        let policies = paths.into_iter().map(|path| {
            let name = path.file_stem().unwrap_or_default();
            let (name, run) = (name.to_string_lossy().into(), run.clone());
            let load = move || Ok(Box::new(run.checkpoint(&path)?.policy) as Box<dyn Controller>);
            PolicyEntry {
                name,
                load: Box::new(load),
            }
        });
        let title = format!("footwork: {}", run.folder.path().display());
        let context = PlaythroughContext::new(matcher, task, Style::BEST);
        window::play(&Gpu::drawing()?, &title, context, policies.collect())
    }

    fn motion(&self) -> Result<()> {
        let (matcher, notes) = data::load_matcher(self.data.as_deref(), Weights::PAPER)?;
        for note in notes {
            tell!("note: {note}");
        }
        // Steered by hand, the character never arrives.
        let task = LocomotionTask::Plane(Plane {
            success_radius: 0.0,
            ..Plane::default()
        });
        let context = PlaythroughContext::new(Arc::new(matcher), task, Style::BEST);
        window::play(&Gpu::drawing()?, "footwork", context, Vec::new())
    }
}
