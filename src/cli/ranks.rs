//! The ranks that `mpiexec` has started this program as.

#[cfg(not(feature = "mpi"))]
use super::usage::Usage;
#[cfg(feature = "mpi")]
use super::{say, usage::exit_code};
use anyhow::Result;
use footwork::ranks::Ranks;

/// Variables that MPI's launchers set: Hydra and Slurm, PMIx, Open MPI.
const NUMBERS: [&str; 3] = ["PMI_RANK", "PMIX_RANK", "OMPI_COMM_WORLD_RANK"];
/// Those of them that say how many ranks there are.
const COUNTS: [&str; 2] = ["PMI_SIZE", "OMPI_COMM_WORLD_SIZE"];

/// Whether a launcher has started this process as one of several, as far as can be known.
fn is_launched() -> bool {
    let value = |name: &&str| std::env::var(name).ok();
    let alone = COUNTS.iter().filter_map(value).any(|count| count == "1");
    !alone && NUMBERS.iter().find_map(value).is_some()
}

/// Does something together with the other ranks, or alone.
#[cfg(not(feature = "mpi"))]
pub fn together(work: impl FnOnce(&Ranks) -> Result<()>) -> Result<()> {
    if is_launched() {
        let why = "mpiexec has started this program several times, but it was built without MPI: build it with \
                   `cargo build --release --features mpi`, or leave out mpiexec";
        return Err(Usage(why.into()).into());
    }
    work(&Ranks::alone())
}

/// Does something together with the other ranks, or alone. An error of one ends all.
#[cfg(feature = "mpi")]
pub fn together(work: impl FnOnce(&Ranks) -> Result<()>) -> Result<()> {
    if !is_launched() {
        return work(&Ranks::alone());
    }
    let mpi = footwork::ranks::Mpi::init()?;
    if std::env::var_os("RAYON_NUM_THREADS").is_none() {
        let threads = rayon::ThreadPoolBuilder::new().num_threads(mpi.cores());
        threads.build_global()?;
    }
    let ranks = Ranks::new(std::sync::Arc::new(mpi.communicator()?));
    if !ranks.is_first() {
        say::silence();
    }
    let outcome = work(&ranks).and_then(|()| say::printed());
    if let Err(error) = &outcome {
        if !ranks.is_first() {
            // What is wrong on all ranks is told by the first, which then ends the others.
            std::thread::sleep(std::time::Duration::from_secs(1));
        }
        say::complain(&format!("error: rank {}: {error:#}", ranks.rank().number));
        mpi.abort(exit_code(error));
    }
    outcome
}
