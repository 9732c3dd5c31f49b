//! Worlds on the CPU of which only some go on, as evaluations do.
//! Oracle: all of them going on. Bar: equal bit for bit.

use crate::inputs::Draw;
use crate::paper::DATABASE;
use footwork::kernels::layout::{AXES, MAP_WORDS, boxes, real, whole};
use footwork::motion::features::TRAJECTORY;
use footwork::world::cpu::CpuWorld;
use footwork::world::{LEVELS, Obstacles, Plane, Setup, Task};
use std::sync::Arc;

const ENVS: usize = 40;

fn world(task: Task) -> CpuWorld {
    let setup = Setup {
        task,
        envs: ENVS,
        horizon: 1,
        seed: 3,
        level: LEVELS - 1,
    };
    CpuWorld::new(Arc::new(DATABASE.clone()), &setup, 0)
}

/// Rows of `width` values of some environments, from `[..][ENVS][width]`.
fn rows<T: Copy>(all: &[T], width: usize, envs: &[usize]) -> Vec<T> {
    let fields = all.chunks(ENVS * width.max(1));
    fields
        .flat_map(|field| {
            envs.iter()
                .flat_map(move |env| field[env * width..][..width].iter().copied())
        })
        .collect()
}

#[track_caller]
fn same(all: &CpuWorld, some: &CpuWorld, envs: &[usize]) {
    let count = all.rules.task.obstacles();
    assert_eq!(some.real.len(), real::FIELDS * envs.len());
    assert_eq!(some.whole.len(), whole::FIELDS * envs.len());
    assert_eq!(some.real, rows(&all.real, 1, envs));
    assert_eq!(some.whole, rows(&all.whole, 1, envs));
    assert_eq!(some.boxes, rows(&all.boxes, boxes::FIELDS * count, envs));
    assert_eq!(some.drift, rows(&all.drift, AXES * count, envs));
    assert_eq!(some.maps, rows(&all.maps, MAP_WORDS, envs));
    assert_eq!(some.ended, rows(&all.ended, 1, envs));
    let width = all.rules.task.width();
    assert_eq!(some.observation(), rows(&all.observation(), width, envs));
}

/// Narrows down to a few environments step by step, playing on in between.
fn narrows(task: Task) {
    let (mut all, mut some) = (world(task), world(task));
    let mut draw = Draw::new(4);
    let mut kept: Vec<usize> = (0..ENVS).collect();
    for keep in [1, 2, 3, 1, 5] {
        let places: Vec<usize> = (0..kept.len())
            .filter(|place| place % keep == keep - 1)
            .collect();
        kept = places.iter().map(|&place| kept[place]).collect();
        some.keep(&places);
        same(&all, &some, &kept);
        for _ in 0..10 {
            let action = draw.normals(ENVS * TRAJECTORY);
            all.play(&action);
            some.play(&rows(&action, TRAJECTORY, &kept));
            same(&all, &some, &kept);
        }
    }
    assert_eq!(kept.len(), 1);
    assert!(some.field(real::TRAVELLED, 0) > 0.0);
}

#[test]
fn a_few_walk_on_among_obstacles_as_among_all() {
    narrows(Task::Obstacles(Obstacles::PRINTED));
}

#[test]
fn a_few_walk_on_on_the_plane_as_among_all() {
    narrows(Task::Plane(Plane::default()));
}

#[test]
fn none_may_be_kept() {
    let mut world = world(Task::Obstacles(Obstacles::PRINTED));
    world.keep(&[]);
    world.play(&[]);
    assert!(world.real.is_empty() && world.observation().is_empty());
}
