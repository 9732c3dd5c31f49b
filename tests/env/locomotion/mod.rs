//! The motion-matching tasks.

mod curriculum;
mod episodes;
mod obstacles;
mod parts;
mod plane;
mod player;
mod restart;
mod resumed;
mod retain;
mod threads;

use footwork::env::locomotion::{EnvConfig, LEVELS, LocomotionTask, Obstacles, Plane};

/// Environments on the last level.
fn config(task: LocomotionTask, envs: usize) -> EnvConfig {
    EnvConfig {
        task,
        envs,
        seed: 42,
        level: LEVELS - 1,
    }
}

/// On both tasks, all of it without a curriculum.
fn tasks() -> [LocomotionTask; 3] {
    let goes_on = Obstacles {
        success_is_terminal: false,
        curriculum: false,
        max_steps: 15,
        ..Obstacles::FAST
    };
    [
        LocomotionTask::Plane(Plane::default()),
        LocomotionTask::Obstacles(Obstacles {
            curriculum: false,
            ..Obstacles::PRINTED
        }),
        LocomotionTask::Obstacles(goes_on),
    ]
}
