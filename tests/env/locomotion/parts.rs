//! A training's environments on the CPU in parts.
//! Oracle: the same environments all in one. Bar: equal bit for bit, but for the summed return.

use super::player::Player;
use super::{config, tasks};
use crate::support::database::MATCHER;
use crate::support::inputs::Draw;
use footwork::env::locomotion::{CpuLocomotion, EnvConfig, LocomotionTask};
use footwork::env::{EnvBatch, VecEnv};
use footwork::gpu::Device;

const STEPS: usize = 40;

/// One part that begins as the parts of a training do.
fn one(config: &EnvConfig) -> Player {
    let jitter = match config.task {
        LocomotionTask::Plane(plane) => plane.max_steps,
        LocomotionTask::Obstacles(_) => 0,
    };
    let part = CpuLocomotion::part(MATCHER.clone(), config, 0, jitter);
    let envs = EnvBatch::new(vec![Box::new(part) as Box<dyn VecEnv>], None);
    Player::new(&Device::Cpu, envs, config, STEPS)
}

fn play_alike(task: LocomotionTask, envs: usize) {
    let config = config(task, envs);
    let (mut all, mut parts) = (one(&config), Player::open(&Device::Cpu, &config, STEPS));
    assert_eq!(parts.envs.parts.len(), envs.min(4));
    assert_eq!(parts.spec(), all.spec());
    let mut draw = Draw::new(4);
    for _ in 0..STEPS {
        let action = all.actions(&mut draw);
        all.step(&action);
        parts.step(&action);
        assert_eq!(all.observation(), parts.observation());
        assert_eq!(all.state(), parts.state());
    }
    assert_eq!(all.rewards(), parts.rewards());
    assert_eq!(all.terminations(), parts.terminations());
    assert_eq!(all.final_observations(), parts.final_observations());
    let (all, parts) = (all.stats(), parts.stats());
    for ((name, want), (_, got)) in all.iter().zip(parts.iter()) {
        let bar = if name == "returns" {
            1e-5 * want.abs()
        } else {
            0.0
        };
        assert!((want - got).abs() <= bar, "{name}: {got} instead of {want}");
    }
    assert!(envs < 50 || all.sum("episodes") > 0.0, "no episode ended");
}

#[test]
fn parts_play_as_all_together() {
    for task in tasks() {
        for envs in [1, 3, 4, 50] {
            play_alike(task, envs);
        }
    }
}
