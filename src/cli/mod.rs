//! One file a subcommand, and what they share.

mod ablate;
#[cfg(feature = "viewer")]
mod bench;
#[cfg(feature = "viewer")]
mod calibrate;
mod compare;
mod data;
mod eval;
mod export;
#[cfg(feature = "viewer")]
mod filming;
mod grid;
#[cfg(feature = "viewer")]
mod latents;
mod opened;
#[cfg(feature = "viewer")]
mod play;
mod progress;
mod ranks;
#[cfg(feature = "viewer")]
mod render;
mod run;
pub mod say;
mod setting;
mod sim;
mod sweep;
mod tournament;
mod train;
mod trainings;
mod usage;
#[cfg(feature = "viewer")]
mod watch;
mod web;

use anyhow::Result;
use clap::{Parser, Subcommand};
use footwork::ranks::Ranks;
pub use usage::{Usage, exit_code};

/// Trains character controllers: motion capture in, a policy that moves a full-body character out.
#[derive(Parser)]
#[command(name = "footwork", version, about, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Train a policy
    Train(train::Train),
    /// Train variants of a task side by side
    Ablate(ablate::Ablate),
    /// Train with every combination of the values of some keys
    Sweep(sweep::Sweep),
    /// Train a policy that acts itself and one that steers skills, side by side
    Compare(compare::Compare),
    /// Evaluate a trained policy on a fixed set of episodes
    Eval(eval::Eval),
    /// Take a trained policy, its motion or its body away in a file that other programs read
    Export(export::Export),
    /// Let trained fighters meet each other: who beats whom, and ratings
    Tournament(tournament::Tournament),
    /// Open a window on a trained policy, or on motion
    #[cfg(feature = "viewer")]
    Play(play::Play),
    /// Draw what a trained policy does, to files
    #[cfg(feature = "viewer")]
    Render(render::Render),
    /// Write a page in which a trained policy runs, for any browser
    Web(web::Web),
    /// Let simulated bodies move by random actions: throughput and statistics
    Sim(sim::Sim),
    /// Measure what each device makes of each stage
    #[cfg(feature = "viewer")]
    Bench(bench::Bench),
    /// Import, synthesise and inspect motion
    #[command(subcommand)]
    Data(data::Data),
}

pub fn run() -> Result<()> {
    let command = Cli::parse().command;
    match command.is_for_ranks() {
        true => ranks::together(|ranks| command.run(ranks))?,
        false => ranks::refuse_several().and_then(|()| command.run(&Ranks::alone()))?,
    }
    say::printed()
}

impl Command {
    fn run(self, ranks: &Ranks) -> Result<()> {
        match self {
            Command::Train(train) => train.run(ranks),
            Command::Ablate(ablate) => ablate.run(ranks),
            Command::Sweep(sweep) => sweep.run(ranks),
            Command::Compare(compare) => compare.run(ranks),
            Command::Eval(eval) => eval.run(),
            Command::Export(export) => export.run(),
            Command::Tournament(tournament) => tournament.run(),
            #[cfg(feature = "viewer")]
            Command::Play(play) => play.run(),
            #[cfg(feature = "viewer")]
            Command::Render(render) => render.run(),
            Command::Web(web) => web.run(),
            Command::Sim(sim) => sim.run(),
            #[cfg(feature = "viewer")]
            Command::Bench(bench) => bench.run(),
            Command::Data(data) => data.run(),
        }
    }

    /// Whether ranks share in it.
    fn is_for_ranks(&self) -> bool {
        matches!(
            self,
            Command::Train(_) | Command::Ablate(_) | Command::Sweep(_) | Command::Compare(_)
        )
    }
}
