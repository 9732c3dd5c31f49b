//! Ranks of an MPI program, whichever library it was built with.

use super::communicator::{Communicator, Rank};
use ferrompi::ThreadLevel;
use std::io::{self, Write};
use std::sync::{Mutex, PoisonError};

/// Numbers up to so many go round whole; of more each rank first sums its share.
const WHOLE: usize = 2048;

/// MPI's world, of which there is one in a process. It must be dropped on the thread that made it.
pub struct Mpi {
    // Dropping it ends MPI.
    _library: ferrompi::Mpi,
    world: ferrompi::Communicator,
    cores: usize,
}

/// What trains: all ranks of the world.
struct World {
    world: ferrompi::Communicator,
    /// What came from the other ranks last, to be used again.
    received: Mutex<Vec<f32>>,
}

impl Mpi {
    /// Joins the other ranks that `mpiexec` has started.
    ///
    /// # Errors
    /// MPI cannot start; its own words.
    pub fn init() -> Result<Mpi, ferrompi::Error> {
        let library = ferrompi::Mpi::init_thread(ThreadLevel::Serialized)?;
        let world = library.world();
        Ok(Mpi {
            cores: cores_of_a_rank(&world.split_shared()?)?,
            world,
            _library: library,
        })
    }

    /// The connection between the ranks.
    ///
    /// # Errors
    /// MPI's own words.
    pub fn communicator(&self) -> Result<impl Communicator + 'static, ferrompi::Error> {
        Ok(World {
            world: self.world.duplicate()?,
            received: Mutex::default(),
        })
    }

    /// Cores for this rank, if its machine's are shared out among the ranks there.
    pub fn cores(&self) -> usize {
        self.cores
    }

    /// Ends all ranks at once, with an exit code.
    pub fn abort(&self, code: u8) -> ! {
        self.world.abort(code.into())
    }
}

/// The cores that a rank may use, divided by the ranks of its machine that may use the same.
fn cores_of_a_rank(machine: &ferrompi::Communicator) -> Result<usize, ferrompi::Error> {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let allowed = status
        .lines()
        .find(|line| line.starts_with("Cpus_allowed:"));
    let own = [crc32fast::hash(allowed.unwrap_or_default().as_bytes())];
    let mut all = vec![0; machine.size() as usize];
    machine.allgather(&own, &mut all)?;
    let sharing = all.iter().filter(|other| **other == own[0]).count();
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    Ok((cores / sharing.max(1)).max(1))
}

impl World {
    /// Ends all ranks if MPI could not do what was asked: there is no way to go on.
    fn checked<T>(&self, result: Result<T, ferrompi::Error>) {
        if let Err(error) = result {
            // Nobody may be listening; that all ranks end is what counts.
            let _ = writeln!(io::stderr(), "error: rank {}: {error}", self.world.rank());
            self.world.abort(1);
        }
    }
}

impl Communicator for World {
    fn rank(&self) -> Rank {
        Rank {
            number: self.world.rank() as usize,
            of: self.world.size() as usize,
        }
    }

    fn sum(&self, values: &mut [f32]) {
        let Rank { number, of } = self.rank();
        let mut received = self.received.lock().unwrap_or_else(PoisonError::into_inner);
        if values.len() <= WHOLE {
            received.resize(values.len() * of, 0.0);
            self.checked(self.world.allgather(values, &mut received));
            in_order(&received, values);
            return;
        }
        // Each rank gets one part of all ranks' numbers, sums it, and tells the others.
        let part = values.len().div_ceil(of);
        let mut sent = values.to_vec();
        sent.resize(part * of, 0.0);
        received.resize(part * of, 0.0);
        self.checked(self.world.alltoall(&sent, &mut received));
        let sums = &mut sent[number * part..][..part];
        in_order(&received, sums);
        let sums = sums.to_vec();
        self.checked(self.world.allgather(&sums, &mut received));
        values.copy_from_slice(&received[..values.len()]);
    }

    fn broadcast(&self, from: usize, bytes: &mut [u8]) {
        self.checked(self.world.broadcast(bytes, from as i32));
    }
}

/// Sums numbers of ranks, one rank's behind the other's, in this order.
fn in_order(ranks: &[f32], sums: &mut [f32]) {
    let mut parts = ranks.chunks_exact(sums.len().max(1));
    if let Some(first) = parts.next() {
        sums.copy_from_slice(first);
    }
    for part in parts {
        for (sum, value) in sums.iter_mut().zip(part) {
            *sum += value;
        }
    }
}
