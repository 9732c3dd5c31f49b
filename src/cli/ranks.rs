//! The ranks that `mpiexec` has started this program as.

use super::usage::Usage;
#[cfg(feature = "mpi")]
use super::{say, usage::exit_code};
use anyhow::Result;
use footwork::ranks::Ranks;
#[cfg(feature = "mpi")]
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Variables that MPI's launchers set: Hydra and Slurm, PMIx, Open MPI.
const NUMBERS: [&str; 3] = ["PMI_RANK", "PMIX_RANK", "OMPI_COMM_WORLD_RANK"];
/// Variables in which launchers say how many processes they have started.
const COUNTS: [&str; 3] = ["PMI_SIZE", "OMPI_COMM_WORLD_SIZE", "SLURM_STEP_NUM_TASKS"];

/// How many processes a launcher has started, if it tells.
fn count() -> Option<usize> {
    let value = |name: &&str| std::env::var(name).ok()?.parse().ok();
    COUNTS.iter().filter_map(value).max()
}

/// Whether a launcher has started this process as one of several, as far as can be known.
fn is_one_of_several() -> bool {
    let value = |name: &&str| std::env::var(name).ok();
    let number = NUMBERS.iter().find_map(value);
    match count() {
        Some(count) => count > 1,
        None => number.is_some_and(|number| number != "0"),
    }
}

/// Refuses to do several times what one process does.
pub fn refuse_several() -> Result<()> {
    match is_one_of_several() {
        false => Ok(()),
        true => Err(Usage(
            "this is done by one process: leave out mpiexec, which is for trainings".into(),
        )
        .into()),
    }
}

/// Does something together with the other ranks, or alone.
#[cfg(not(feature = "mpi"))]
pub fn together(work: impl FnOnce(&Ranks) -> Result<()>) -> Result<()> {
    if is_one_of_several() {
        let why = "mpiexec has started this program several times, but it was built without MPI: build it with \
                   `cargo build --release --features mpi`, or leave out mpiexec";
        return Err(Usage(why.into()).into());
    }
    work(&Ranks::alone())
}

/// Does something together with the other ranks, or alone. An error of one ends all, and so does a panic.
#[cfg(feature = "mpi")]
pub fn together(work: impl FnOnce(&Ranks) -> Result<()>) -> Result<()> {
    let is_launched = NUMBERS.iter().any(|name| std::env::var_os(name).is_some());
    if !is_launched && !is_one_of_several() {
        return work(&Ranks::alone());
    }
    let mpi = footwork::ranks::Mpi::init()?;
    let joined = AssertUnwindSafe(|| joined(&mpi, work));
    match catch_unwind(joined) {
        Ok(Ok(())) => Ok(()),
        Ok(Err(error)) => mpi.abort(exit_code(&error)),
        // Its message has been printed.
        Err(_) => mpi.abort(101),
    }
}

/// Does something as one of the ranks. What goes wrong is told before it is returned.
#[cfg(feature = "mpi")]
fn joined(mpi: &footwork::ranks::Mpi, work: impl FnOnce(&Ranks) -> Result<()>) -> Result<()> {
    if std::env::var_os("RAYON_NUM_THREADS").is_none() {
        let threads = rayon::ThreadPoolBuilder::new().num_threads(mpi.cores());
        threads.build_global()?;
    }
    let ranks = Ranks::new(std::sync::Arc::new(mpi.communicator()?));
    if !ranks.is_first() {
        say::silence();
    }
    let outcome = checked(&ranks).and_then(|()| work(&ranks));
    let outcome = outcome.and_then(|()| say::printed());
    match &outcome {
        Ok(()) => {}
        Err(error) if ranks.is_first() => say::complain(&format!("error: {error:#}")),
        Err(error) => {
            // What is wrong on all ranks is told by the first, which then ends the others.
            std::thread::sleep(std::time::Duration::from_secs(1));
            say::complain(&format!("error: rank {}: {error:#}", ranks.rank().number));
        }
    }
    outcome
}

/// Refuses ranks that do not know each other.
#[cfg(feature = "mpi")]
fn checked(ranks: &Ranks) -> Result<()> {
    match count() {
        Some(count) if count != ranks.count() => Err(Usage(format!(
            "{count} processes have been started, but MPI knows of {}: start them by the launcher of the MPI library \
             that this was built with; Slurm wants `srun --mpi=pmi2` or `--mpi=pmix`",
            ranks.count()
        ))
        .into()),
        _ => Ok(()),
    }
}
