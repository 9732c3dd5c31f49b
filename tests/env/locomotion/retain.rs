//! Environments on the CPU of which only some go on, as evaluations do.
//! Oracle: all of them going on. Bar: equal bit for bit.

use super::config;
use crate::support::database::MATCHER;
use crate::support::inputs::Draw;
use footwork::env::locomotion::{CpuLocomotion, LocomotionTask, Obstacles, Plane};
use footwork::kernels::locomotion::locomotion_layout::{
    MAP_WORDS, VELOCITY_DIM, boxes, state_f32, state_u32,
};
use footwork::motion::features::TRAJECTORY_DIM;

const ENVS: usize = 40;

fn environments(task: LocomotionTask) -> CpuLocomotion {
    CpuLocomotion::new(MATCHER.clone(), &config(task, ENVS))
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
fn same(all: &CpuLocomotion, some: &CpuLocomotion, envs: &[usize]) {
    let count = all.params.task.obstacles();
    assert_eq!(some.state_f32.len(), state_f32::FIELDS * envs.len());
    assert_eq!(some.state_u32.len(), state_u32::FIELDS * envs.len());
    assert_eq!(some.state_f32, rows(&all.state_f32, 1, envs));
    assert_eq!(some.state_u32, rows(&all.state_u32, 1, envs));
    assert_eq!(some.boxes, rows(&all.boxes, boxes::FIELDS * count, envs));
    assert_eq!(
        some.obstacle_velocity,
        rows(&all.obstacle_velocity, VELOCITY_DIM * count, envs)
    );
    assert_eq!(some.maps, rows(&all.maps, MAP_WORDS, envs));
    assert_eq!(some.termination, rows(&all.termination, 1, envs));
    let width = all.params.observation_dim();
    assert_eq!(some.observation(), rows(&all.observation(), width, envs));
}

/// Narrows down to a few environments step by step, playing on in between.
fn narrows(task: LocomotionTask) {
    let (mut all, mut some) = (environments(task), environments(task));
    let mut draw = Draw::new(4);
    let mut kept: Vec<usize> = (0..ENVS).collect();
    for keep in [1, 2, 3, 1, 5] {
        let places: Vec<usize> = (0..kept.len())
            .filter(|place| place % keep == keep - 1)
            .collect();
        kept = places.iter().map(|&place| kept[place]).collect();
        some.retain(&places);
        same(&all, &some, &kept);
        for _ in 0..10 {
            let action = draw.normals(ENVS * TRAJECTORY_DIM);
            all.step_without_reset(&action);
            some.step_without_reset(&rows(&action, TRAJECTORY_DIM, &kept));
            same(&all, &some, &kept);
        }
    }
    assert_eq!(kept.len(), 1);
    assert!(some.field(state_f32::TRAVELLED, 0) > 0.0);
}

#[test]
fn a_few_walk_on_among_obstacles_as_among_all() {
    narrows(LocomotionTask::Obstacles(Obstacles::PRINTED));
}

#[test]
fn a_few_walk_on_on_the_plane_as_among_all() {
    narrows(LocomotionTask::Plane(Plane::default()));
}

#[test]
fn none_may_be_retained() {
    let mut envs = environments(LocomotionTask::Obstacles(Obstacles::PRINTED));
    envs.retain(&[]);
    envs.step_without_reset(&[]);
    assert!(envs.state_f32.is_empty() && envs.observation().is_empty());
}
