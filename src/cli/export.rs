//! `footwork export`.

use super::run::{Moved, Run};
use super::say::say;
use anyhow::{Result, bail};
use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use footwork::container::write_whole;
use footwork::export::{ExportFormat, FORMATS, TrainedRun, export};
use std::path::PathBuf;

#[derive(Args)]
pub struct Export {
    /// A run's folder, whose last checkpoint is exported, or one of its checkpoints
    run: PathBuf,
    /// What kind of file
    #[arg(long, value_name = "FORMAT", value_parser = formats())]
    format: &'static ExportFormat,
    /// The file to write
    #[arg(short, long, value_name = "FILE")]
    out: PathBuf,
    /// Write over what is there
    #[arg(long)]
    force: bool,
    /// Where the run's motion is now, if it has been moved
    #[arg(long, value_name = "DIR|FILE")]
    data: Option<PathBuf>,
    /// Where the low level is now that the run steers, if it has been moved
    #[arg(long, value_name = "RUN")]
    skills: Option<PathBuf>,
}

/// A format by name.
fn formats() -> impl TypedValueParser<Value = &'static ExportFormat> {
    let names = FORMATS.iter();
    let names = names.map(|format| PossibleValue::new(format.name).help(format.about));
    PossibleValuesParser::new(names).try_map(|name| {
        let found = FORMATS.iter().find(|format| format.name == name);
        found.ok_or("there is no such format")
    })
}

impl Export {
    pub fn run(self) -> Result<()> {
        self.check_out()?;
        let moved = Moved {
            data: self.data.as_deref(),
            skills: self.skills.as_deref(),
        };
        let run = Run::open(&self.run, moved)?;
        let checkpoint = run.checkpoint(&run.path)?;
        let trained = TrainedRun {
            config: &run.config,
            task: &*run.task,
            checkpoint: &checkpoint,
        };
        write_whole(&self.out, &export(&trained, self.format)?)?;
        say!("{}", self.out.display());
        Ok(())
    }

    /// Refuses an impossible file before anything is opened.
    fn check_out(&self) -> Result<()> {
        let path = self.out.display();
        if self.out.is_dir() {
            bail!("{path} is a folder: --out is the file to write");
        }
        if self.out.exists() && !self.force {
            bail!("{path} exists: give --force to write over it");
        }
        let folder = self.out.parent().unwrap_or(&self.out);
        if !folder.as_os_str().is_empty() && !folder.is_dir() {
            bail!("there is no folder {}", folder.display());
        }
        Ok(())
    }
}
