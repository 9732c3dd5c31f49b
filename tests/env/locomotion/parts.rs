//! A training's worlds on the CPU in parts.
//! Oracle: the same worlds all together. Bar: equal bit for bit.

use crate::inputs::Draw;
use crate::paper::DATABASE;
use burn::tensor::Tensor;
use footwork::gpu::Device;
use footwork::motion::features::TRAJECTORY_DIM;
use footwork::nn::tensors::{read, upload, vector};
use footwork::env::locomotion::{self, Batch, LEVELS, Obstacles, Plane, Setup, Task};
use std::sync::Arc;

const STEPS: usize = 40;

/// Plays the same means through both, one part after another, and puts back what it was in between.
fn same(task: Task, envs: usize) {
    let database = Arc::new(DATABASE.clone());
    let device = Device::Cpu;
    let setup = Setup {
        task,
        envs,
        horizon: STEPS,
        seed: 3,
        level: LEVELS - 1,
    };
    let mut all = locomotion::open(&device, &database, &setup);
    let mut batch = Batch::open(&device, &database, &setup);
    assert_eq!(batch.parts.len(), envs.min(4));
    let log_std = vector(&[0.0; TRAJECTORY_DIM], &device.tensors());
    let mut draw = Draw::new(4);
    for step in 0..STEPS {
        let mean = draw.normals(envs * TRAJECTORY_DIM);
        let mean = upload(mean, [envs, TRAJECTORY_DIM], &device.tensors());
        let observed = all.observe();
        let (action, _) = all.act(mean.clone(), log_std.clone());
        all.step(action);
        let (mut first, mut seen) = (0, Vec::new());
        for part in &mut batch.parts {
            let observed = part.observe();
            let count = observed.dims()[0];
            let mean = mean.clone().narrow(0, first, count);
            let (action, _) = part.act(mean, log_std.clone());
            part.step(action);
            seen.push(observed);
            first += count;
        }
        let seen = Tensor::cat(seen, 0);
        assert_eq!(read(observed).unwrap(), read(seen).unwrap());
        assert_eq!(all.snapshot().unwrap(), batch.snapshot().unwrap());
        if step == STEPS / 2 {
            batch = Batch::open(&device, &database, &setup);
            batch.restore(&all.snapshot().unwrap());
        }
    }
    let [all, parts] = [all.tally(), batch.tally()].map(|sums| read(sums).unwrap());
    assert_eq!(all[..5], parts[..5]);
    assert!(
        (all[5] - parts[5]).abs() <= 1e-5 * all[5].abs(),
        "{all:?} {parts:?}"
    );
    assert!(envs < 50 || all[0] > 0.0, "no episode ended");
}

#[test]
fn parts_walk_on_the_plane_as_all_together() {
    for envs in [1, 3, 4, 50] {
        same(Task::Plane(Plane::default()), envs);
    }
}

#[test]
fn parts_walk_among_obstacles_as_all_together() {
    same(Task::Obstacles(Obstacles::FAST), 50);
}
