//! `footwork web`.

use super::run::{Moved, Run};
use super::say::{say, tell};
use anyhow::Result;
use clap::Args;
use footwork::train::task::Unsupported;
use footwork::web::folder::RunFiles;
use std::path::PathBuf;

/// This crate for browsers, which `web/build` makes.
const MODULE: &[u8] = include_bytes!("../../web/footwork.wasm");

#[derive(Args)]
pub struct Web {
    /// A run's folder, whose last checkpoint is played, or one of its checkpoints
    run: PathBuf,
    /// Folder of the page
    #[arg(short, long, value_name = "DIR")]
    out: PathBuf,
    /// Replace a page that is there
    #[arg(long)]
    force: bool,
    /// Where the run's motion is now, if it has been moved
    #[arg(long, value_name = "DIR|FILE")]
    data: Option<PathBuf>,
}

impl Web {
    pub fn run(self) -> Result<()> {
        let moved = Moved {
            data: self.data.as_deref(),
            skills: None,
        };
        let run = Run::open(&self.run, moved)?;
        let files = files(&run)?;
        let bytes = files.write(&self.out, MODULE, self.force)?;
        let out = self.out.display();
        say!(
            "{out}: {:.1} MB, {:.1} MB of it before the first step",
            bytes as f64 / 1e6,
            (MODULE.len() + files.first_bytes()) as f64 / 1e6
        );
        tell!("see it: python3 -m http.server --directory {out}, then http://localhost:8000");
        Ok(())
    }
}

fn files(run: &Run) -> Result<RunFiles> {
    let checkpoint = run.checkpoint(&run.path)?;
    let (steps, policy) = (checkpoint.header.steps, checkpoint.policy);
    let task = &run.config.task.name;
    if run.config.skills.is_some() {
        let why = format!(
            "a page cannot carry this run: its policy steers the low level of another one. It can carry runs of every \
             task, `{task}` too, that were trained without --skills, and the low level itself"
        );
        return Err(Unsupported(why).into());
    }
    match (run.task.locomotion(), run.task.body()) {
        (Some(locomotion), _) => RunFiles::of_locomotion(task, steps, &policy, locomotion),
        (None, Some(body)) => RunFiles::of_body(task, steps, &policy, &run.config, &body),
        (None, None) => Err(Unsupported(format!("there is nothing to see of `{task}`")).into()),
    }
}
