//! What ranks need of whatever connects them.

/// One of the processes that train together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rank {
    /// Its number, from 0.
    pub number: usize,
    /// How many there are.
    pub of: usize,
}

/// Connects ranks. All of them make the same calls in the same order, each of which ends when this rank's part is done.
/// There are no errors to go on from: where a rank or the network fails, all ranks end.
pub trait Communicator: Send + Sync {
    /// Which rank this is.
    fn rank(&self) -> Rank;

    /// Replaces numbers, as many on every rank, by their sums over the ranks: rank 0's, plus rank 1's, and so on.
    fn sum(&self, values: &mut [f32]);

    /// Replaces bytes, as many on every rank, by those of one rank.
    fn broadcast(&self, from: usize, bytes: &mut [u8]);
}
