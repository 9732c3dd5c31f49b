//! `footwork ablate`.

use super::Usage;
use super::train::{Choices, on_interrupt, open};
use anyhow::Result;
use clap::{Args, Subcommand};
use footwork::train::ablation::{PARTS, READINGS, Variant, ablate, summary};
use footwork::train::config::Kind;
use std::path::PathBuf;

#[derive(Subcommand)]
pub enum Ablate {
    /// The task with obstacles: the method whole, without its hit reward, without its curriculum
    Obstacles(Choice),
    /// The task with obstacles: the paper's reward as printed, and other readings of it
    Readings(Choice),
}

#[derive(Args)]
pub struct Choice {
    #[command(flatten)]
    choices: Choices,
    /// Trainings of each variant, from the seeds 1, 2, ..
    #[arg(
        long,
        default_value_t = 3,
        value_name = "N",
        allow_negative_numbers = true
    )]
    seeds: u32,
    /// Folder of all its runs; given again, it goes on where it was [default: runs/ablation or
    /// runs/readings]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

impl Ablate {
    pub fn run(self) -> Result<()> {
        match self {
            Ablate::Obstacles(choice) => choice.run(&PARTS, "runs/ablation"),
            Ablate::Readings(choice) => choice.run(&READINGS, "runs/readings"),
        }
    }
}

impl Choice {
    fn run(self, variants: &[Variant], folder: &str) -> Result<()> {
        let out = self.out.unwrap_or(folder.into());
        if self.seeds == 0 || self.seeds > 100 {
            return Err(Usage("--seeds must be from 1 to 100".into()).into());
        }
        let interrupted = on_interrupt()?;
        let mut config = self.choices.config(Kind::Obstacles)?;
        let (device, database) = open(&mut config)?;
        let outcomes = ablate(
            variants,
            &config,
            self.seeds,
            &out,
            &database,
            &device,
            interrupted,
        )?;
        match outcomes {
            Some(outcomes) => print!("{}", summary(variants, &outcomes)),
            None => println!("go on with the same command"),
        }
        println!("see {}", out.display());
        Ok(())
    }
}
