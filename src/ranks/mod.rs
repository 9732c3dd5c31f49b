//! Processes that train together, each with its share of the environments.
//!
//! The words are MPI's: a *rank* is one of the processes, and its number. Whatever ranks must agree on is either summed
//! over them or told by the first, so that each of them computes the same from then on. Sums are taken in the order of
//! the ranks: their bits depend on how many there are, and on nothing else.

mod communicator;
#[cfg(feature = "mpi")]
mod mpi;

use crate::gpu::{Array, Device};
use anyhow::{Result, bail};
pub use communicator::{Communicator, Rank};
#[cfg(feature = "mpi")]
pub use mpi::Mpi;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// The ranks of a training, seen from one of them. Copies share the clock of what communication takes.
#[derive(Clone)]
pub struct Ranks {
    rank: Rank,
    /// None of a process that trains alone.
    communicator: Option<Arc<dyn Communicator>>,
    nanoseconds: Arc<AtomicU64>,
}

impl Ranks {
    /// A process that trains alone.
    pub fn alone() -> Ranks {
        Ranks {
            rank: Rank { number: 0, of: 1 },
            communicator: None,
            nanoseconds: Arc::default(),
        }
    }

    /// Those that a communicator connects.
    pub fn new(communicator: Arc<dyn Communicator>) -> Ranks {
        Ranks {
            rank: communicator.rank(),
            communicator: Some(communicator),
            nanoseconds: Arc::default(),
        }
    }

    /// Which of the ranks this is.
    pub fn rank(&self) -> Rank {
        self.rank
    }

    /// How many ranks there are.
    pub fn count(&self) -> usize {
        self.rank.of
    }

    /// Whether this is the first rank, which alone writes files and talks to the user.
    pub fn is_first(&self) -> bool {
        self.rank.number == 0
    }

    /// Whether there is nobody else.
    pub fn is_alone(&self) -> bool {
        self.rank.of == 1
    }

    /// This rank's share of things that are numbered through.
    pub fn share(&self, all: usize) -> Range<usize> {
        let Rank { number, of } = self.rank;
        all * number / of..all * (number + 1) / of
    }

    /// How many of `all` samples of a batch each rank looks at, the same number on all: a few more where they cannot be
    /// shared out evenly.
    pub fn portion(&self, all: usize) -> usize {
        all.div_ceil(self.rank.of)
    }

    /// Adds up the numbers of all ranks, in the order of the ranks.
    pub fn sum(&self, values: &mut [f32]) {
        self.timed(|communicator| communicator.sum(values));
    }

    /// [`Ranks::sum`] of arrays of a device, all in one message.
    ///
    /// # Errors
    /// The device was lost.
    pub fn sum_arrays(&self, device: &Device, arrays: &mut [&mut Array]) -> Result<()> {
        if self.is_alone() {
            return Ok(());
        }
        let own = arrays.iter().map(|array| array.read(device));
        let mut values = own.collect::<Result<Vec<_>>>()?.concat();
        self.sum(&mut values);
        let mut rest = &values[..];
        for array in arrays {
            let (own, others) = rest.split_at(array.len());
            **array = Array::from_slice(device, own);
            rest = others;
        }
        Ok(())
    }

    /// Whether it is so on any rank.
    pub fn any(&self, own: bool) -> bool {
        let mut sum = [f32::from(u8::from(own))];
        self.sum(&mut sum);
        sum[0] > 0.0
    }

    /// The arrays of all ranks, which are of one length, one behind the other.
    ///
    /// # Errors
    /// The device was lost.
    pub fn join(&self, device: &Device, own: &Array) -> Result<Array> {
        if self.is_alone() {
            return Ok(own.clone());
        }
        let mut all = vec![0.0; own.len() * self.rank.of];
        all[own.len() * self.rank.number..][..own.len()].copy_from_slice(&own.read(device)?);
        self.sum(&mut all);
        Ok(Array::from_slice(device, &all))
    }

    /// Lets every rank have what the first one has.
    pub fn broadcast(&self, bytes: &mut Vec<u8>) {
        self.send(0, bytes);
    }

    /// What each rank has, in their order.
    pub fn gather(&self, own: &[u8]) -> Vec<Vec<u8>> {
        let sent = |from: usize| {
            let mut bytes = match from == self.rank.number {
                true => own.to_vec(),
                false => Vec::new(),
            };
            self.send(from, &mut bytes);
            bytes
        };
        (0..self.rank.of).map(sent).collect()
    }

    /// What went well on all ranks. Where it did not on one, all get its error.
    ///
    /// # Errors
    /// That of the first rank that has one.
    pub fn all_or_none<T>(&self, own: Result<T>) -> Result<T> {
        if self.is_alone() {
            return own;
        }
        let error = own.as_ref().err().map(|error| format!("{error:#}"));
        let errors = self.gather(error.unwrap_or_default().as_bytes());
        let failed = errors.iter().position(|error| !error.is_empty());
        match (failed, own) {
            (None, own) => own,
            (Some(rank), Err(own)) if rank == self.rank.number => Err(own),
            (Some(rank), _) => bail!("rank {rank}: {}", String::from_utf8_lossy(&errors[rank])),
        }
    }

    /// Seconds that this rank has spent in communication, waiting for others included.
    pub fn seconds(&self) -> f64 {
        Duration::from_nanos(self.nanoseconds.load(Ordering::Relaxed)).as_secs_f64()
    }

    /// Lets every rank have the bytes of one.
    fn send(&self, from: usize, bytes: &mut Vec<u8>) {
        self.timed(|communicator| {
            let mut len = (bytes.len() as u64).to_le_bytes();
            communicator.broadcast(from, &mut len);
            bytes.resize(u64::from_le_bytes(len) as usize, 0);
            communicator.broadcast(from, bytes);
        });
    }

    /// Does something with the communicator, unless there is nobody else.
    fn timed(&self, work: impl FnOnce(&dyn Communicator)) {
        let (false, Some(communicator)) = (self.is_alone(), &self.communicator) else {
            return;
        };
        let start = Instant::now();
        work(&**communicator);
        let passed = start.elapsed().as_nanos() as u64;
        self.nanoseconds.fetch_add(passed, Ordering::Relaxed);
    }
}
