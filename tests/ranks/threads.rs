//! Ranks as threads of one process.

use footwork::ranks::{Communicator, Rank, Ranks};
use std::sync::{Arc, Barrier, Mutex};

/// What threads share.
struct Shared {
    turn: Barrier,
    sums: Mutex<Vec<Vec<f32>>>,
    bytes: Mutex<Vec<u8>>,
    /// Sums, and their numbers.
    counts: Mutex<[usize; 2]>,
}

struct Thread {
    rank: Rank,
    shared: Arc<Shared>,
}

impl Communicator for Thread {
    fn rank(&self) -> Rank {
        self.rank
    }

    fn sum(&self, values: &mut [f32]) {
        if self.rank.number == 0 {
            let mut counts = self.shared.counts.lock().unwrap();
            *counts = [counts[0] + 1, counts[1] + values.len()];
        }
        self.shared.sums.lock().unwrap()[self.rank.number] = values.to_vec();
        self.shared.turn.wait();
        let all = self.shared.sums.lock().unwrap().clone();
        for (at, value) in values.iter_mut().enumerate() {
            let of_ranks = all.iter().map(|own| own[at]);
            *value = of_ranks.reduce(|sum, own| sum + own).unwrap();
        }
        self.shared.turn.wait();
    }

    fn broadcast(&self, from: usize, bytes: &mut [u8]) {
        if from == self.rank.number {
            *self.shared.bytes.lock().unwrap() = bytes.to_vec();
        }
        self.shared.turn.wait();
        bytes.copy_from_slice(&self.shared.bytes.lock().unwrap());
        self.shared.turn.wait();
    }
}

/// Does something on each of `count` ranks, with a core each; what they return, in their order.
pub fn together<T: Send>(count: usize, work: impl Fn(&Ranks) -> T + Sync) -> Vec<T> {
    counted(count, work).0
}

/// How many sums are taken when something is done on each of `count` ranks, and of how many numbers in all.
pub fn sums_of(count: usize, work: impl Fn(&Ranks) + Sync) -> [usize; 2] {
    counted(count, work).1
}

fn counted<T: Send>(count: usize, work: impl Fn(&Ranks) -> T + Sync) -> (Vec<T>, [usize; 2]) {
    let shared = Arc::new(Shared {
        turn: Barrier::new(count),
        sums: Mutex::new(vec![Vec::new(); count]),
        bytes: Mutex::default(),
        counts: Mutex::default(),
    });
    let work = &work;
    let done = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..count)
            .map(|number| {
                let rank = Rank { number, of: count };
                let shared = shared.clone();
                scope.spawn(move || {
                    let core = rayon::ThreadPoolBuilder::new().num_threads(1);
                    let ranks = Ranks::new(Arc::new(Thread { rank, shared }));
                    core.build().unwrap().install(|| work(&ranks))
                })
            })
            .collect();
        let done = threads.into_iter().map(|thread| thread.join().unwrap());
        done.collect()
    });
    let counts = *shared.counts.lock().unwrap();
    (done, counts)
}
