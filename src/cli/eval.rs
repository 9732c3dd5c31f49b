//! `footwork eval`.

use super::Usage;
use super::run::{Moved, Run};
use super::say::{say, show};
use anyhow::Result;
use clap::Args;
use footwork::train::body_policy::{BodyPolicy, StyleReport};
use footwork::train::checkpoint::Checkpoint;
use footwork::train::evaluation::EvalOptions;
use std::path::PathBuf;

/// Episodes whose style is judged.
const STYLE_EPISODES: usize = 64;

#[derive(Args)]
pub struct Eval {
    /// A run's folder, whose last checkpoint is evaluated, or one of its checkpoints
    run: PathBuf,
    /// Where the run's motion is now, if it has been moved
    #[arg(long, value_name = "DIR|FILE")]
    data: Option<PathBuf>,
    /// Episodes, the same ones for every policy
    #[arg(
        long,
        default_value_t = 1000,
        value_name = "N",
        allow_negative_numbers = true
    )]
    episodes: usize,
    /// Evaluate scripted motion matching beside it: a straight trajectory to the target
    #[arg(long)]
    baseline: bool,
    /// Among obstacles: plan so many of the episodes on the hardest level with full knowledge of
    /// everything, to see what can be reached at all
    #[arg(
        long,
        default_value_t = 0,
        value_name = "N",
        hide_default_value = true,
        allow_negative_numbers = true
    )]
    planner: usize,
    /// Rate the whole body's motion: feet that slide or sink, and what the jumps between clips leave
    /// to be seen, with each remedy
    #[arg(long)]
    motion_quality: bool,
    /// Rate a run of skills: what its latents lead to; of a run that steers a low level, where that is now, if it
    /// has been moved
    #[arg(long, value_name = "RUN")]
    skills: Option<Option<PathBuf>>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

impl Eval {
    pub fn run(self) -> Result<()> {
        if self.episodes == 0 || self.episodes > 1_000_000 {
            return Err(Usage("--episodes must be from 1 to 1000000".into()).into());
        }
        let moved = Moved {
            data: self.data.as_deref(),
            skills: self.skills.as_ref().and_then(|run| run.as_deref()),
        };
        let run = Run::open(&self.run, moved)?;
        if matches!(self.skills, Some(None)) && run.config.ase.is_none() {
            let (path, task) = (self.run.display(), &run.config.task.name);
            let why = format!("--skills: {path} is a run of `{task}`, which has no skills");
            return Err(Usage(why).into());
        }
        let checkpoint = run.checkpoint(&run.path)?;
        let wanted = EvalOptions {
            episodes: self.episodes,
            baseline: self.baseline,
            planner: self.planner,
            motion_quality: self.motion_quality,
        };
        let mut report = run.task.report(&checkpoint.policy, &wanted)?;
        let steps = checkpoint.header.steps;
        if let Some(found) = self.style(&run, checkpoint)? {
            report.json["style"] = found.style.into();
            report.text += &format!("style reward {:.2} a step\n", found.style);
            if let Some(cosine) = found.encoder_cosine {
                report.json["encoder_cosine"] = cosine.into();
                report.text += &format!("the encoder finds latents with a cosine of {cosine:.2}\n");
            }
        }
        match self.json {
            true => say!("{}", report.json),
            false => show!(
                "{} at {steps} steps, {} episodes\n{}",
                run.path.display(),
                self.episodes,
                report.text
            ),
        }
        Ok(())
    }

    /// What a run's discriminator says of a body's first episodes.
    fn style(&self, run: &Run, checkpoint: Checkpoint) -> Result<Option<StyleReport>> {
        let Some(episodes) = run.task.body() else {
            return Ok(None);
        };
        let mut envs = episodes.open_all(self.episodes.min(STYLE_EPISODES));
        Ok(BodyPolicy::new(checkpoint, &run.config, &*run.task)?.judged(&mut envs))
    }
}
