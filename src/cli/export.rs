//! `footwork export`.

use super::Usage;
use super::run::{MovedFiles, Run};
use super::say::say;
use anyhow::{Result, bail};
use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use footwork::container::write_whole;
use footwork::export::{Excerpt, ExportFormat, FORMATS, TrainedRun, export};
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
    #[command(flatten)]
    files: MovedFiles,
    /// Which of the evaluation's episodes, of motion [default: 0]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    episode: Option<usize>,
    /// Length of the motion, s, unless the episode ends before [default: 6]
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    seconds: Option<f32>,
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
        let excerpt = self.excerpt()?;
        self.check_out()?;
        let run = Run::open(&self.run, self.files.moved())?;
        let checkpoint = run.checkpoint(&run.path)?;
        let trained = TrainedRun {
            config: &run.config,
            task: &*run.task,
            checkpoint: &checkpoint,
            excerpt,
        };
        write_whole(&self.out, &export(&trained, self.format)?)?;
        say!("{}", self.out.display());
        Ok(())
    }

    /// What of the motion is asked for.
    fn excerpt(&self) -> Result<Excerpt, Usage> {
        if (self.episode.is_some() || self.seconds.is_some()) && !self.format.motion {
            let formats = FORMATS.iter().filter(|format| format.motion);
            let names: Vec<&str> = formats.map(|format| format.name).collect();
            let names = names.join(" and ");
            return Err(Usage(format!("--episode and --seconds are for {names}")));
        }
        let excerpt = Excerpt {
            episode: self.episode.unwrap_or(0),
            seconds: self.seconds.unwrap_or(6.0),
        };
        if excerpt.episode >= 1000 {
            return Err(Usage("--episode must be from 0 to 999".into()));
        }
        if !(excerpt.seconds > 0.0 && excerpt.seconds <= 600.0) {
            return Err(Usage("--seconds must be over 0 and at most 600".into()));
        }
        Ok(excerpt)
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
