//! What is played does not depend on how many threads play it.
//! Bar: equal bit for bit.

use super::player::Player;
use super::{config, tasks};
use crate::support::inputs::Draw;
use footwork::env::locomotion::{EnvState, LocomotionTask};
use footwork::gpu::Device;
use rayon::ThreadPoolBuilder;

const STEPS: usize = 30;

/// State, rewards and sums after some steps on so many threads.
fn played(task: LocomotionTask, threads: usize) -> (EnvState, Vec<f32>, Vec<f64>) {
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    pool.expect("threads").install(|| {
        let mut player = Player::open(&Device::Cpu, &config(task, 70), STEPS);
        let mut draw = Draw::new(9);
        for _ in 0..STEPS {
            let action = player.actions(&mut draw);
            player.step(&action);
        }
        let sums = player.stats().iter().map(|(_, sum)| sum).collect();
        (player.state(), player.rewards(), sums)
    })
}

#[test]
fn any_number_of_threads_plays_the_same() {
    for task in tasks() {
        let alone = played(task, 1);
        for threads in [2, 3, 7] {
            assert!(played(task, threads) == alone, "{threads} threads");
        }
    }
}
