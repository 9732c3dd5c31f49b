//! Episodes by the words of the seam: a step that ends one begins the next, final observations are those
//! before it, statistics are sums over the episodes that ended.
//! Oracle: the same environments on the CPU, stepped without reset.

use super::player::{Player, devices};
use super::{config, tasks};
use crate::support::database::MATCHER;
use crate::support::inputs::{Draw, POISON};
use footwork::container::Section;
use footwork::env::locomotion::{CpuLocomotion, EnvState, LocomotionTask, STAT_NAMES};
use footwork::env::{VecEnv, termination};
use footwork::gpu::Device;
use footwork::kernels::locomotion::locomotion_layout::{BASE_OBS_DIM, state_u32};

const ENVS: usize = 70;
const STEPS: usize = 16;

/// The environments of a state, to be stepped by themselves.
fn copy(task: LocomotionTask, state: &EnvState) -> CpuLocomotion {
    let mut copy = CpuLocomotion::new(MATCHER.clone(), &config(task, ENVS));
    let mut section = Section::default();
    state.save(&mut section);
    copy.load(&mut section).expect("the same environments");
    copy
}

/// With short episodes, many of which are truncated.
fn short(mut task: LocomotionTask) -> LocomotionTask {
    match &mut task {
        LocomotionTask::Plane(task) => task.max_steps = 6,
        LocomotionTask::Obstacles(task) => task.max_steps = 6,
    }
    task
}

/// Plays rollouts, and compares their final observations with those of the states before reset.
fn final_observations(task: LocomotionTask, device: &Device) {
    let mut player = Player::together(device, &config(task, ENVS), STEPS);
    let (spec, mut draw) = (player.spec(), Draw::new(2));
    let dim = spec.observation.dim();
    let mut written = 0;
    for _ in 0..4 {
        let mut expected = vec![POISON; spec.final_steps(STEPS) * ENVS * dim];
        for step in 0..STEPS {
            let action = player.actions(&mut draw);
            let mut before = copy(task, &player.state());
            before.step_without_reset(&action);
            player.step(&action);
            let terminations = &player.terminations()[step * ENVS..][..ENVS];
            assert_eq!(terminations, before.termination);
            let last = before.observation();
            let after = player.state();
            for (env, &end) in terminations.iter().enumerate() {
                let age = after.state_u32[state_u32::EPISODE_STEP * ENVS + env];
                assert_eq!(age == 0, end != termination::RUNNING, "same-step reset");
                if end != termination::RUNNING && spec.bootstrap >> end & 1 == 1 {
                    let row = spec.final_row(step) + env;
                    expected[row * dim..][..dim].copy_from_slice(&last[env * dim..][..dim]);
                    written += 1;
                }
            }
        }
        for (i, (got, want)) in player
            .final_observations()
            .iter()
            .zip(&expected)
            .enumerate()
        {
            let (row, number) = (i / dim, i % dim);
            let bar = match device {
                _ if *got == POISON || *want == POISON => 0.0,
                Device::Cpu => 0.0,
                Device::Gpu(_) if number < BASE_OBS_DIM => 1e-4,
                // A step of a cell's byte.
                Device::Gpu(_) => 1.001 / 255.0,
            };
            assert!(
                (got - want).abs() <= bar,
                "row {row}, {number}: {got} instead of {want}"
            );
        }
    }
    assert!(written > 0, "no value went on");
}

#[test]
fn final_observations_are_those_of_episodes_whose_value_goes_on() {
    for device in devices() {
        for task in tasks() {
            final_observations(short(task), &device);
        }
    }
}

/// Sums over the episodes that ended, made from the columns.
#[test]
fn statistics_are_sums_over_the_episodes_that_ended() {
    for device in devices() {
        for task in tasks() {
            let mut player = Player::together(&device, &config(task, ENVS), STEPS);
            assert_eq!(player.envs.stat_names(), STAT_NAMES);
            let (mut returns, mut lengths) = (vec![0.0; ENVS], vec![0.0; ENVS]);
            let mut draw = Draw::new(3);
            for _ in 0..4 {
                for _ in 0..STEPS {
                    let action = player.actions(&mut draw);
                    player.step(&action);
                }
                let mut sums = [0.0; STAT_NAMES.len()];
                let columns = player.rewards().into_iter().zip(player.terminations());
                for (at, (reward, end)) in columns.enumerate() {
                    let env = at % ENVS;
                    returns[env] += f64::from(reward);
                    lengths[env] += 1.0;
                    if end == termination::RUNNING {
                        continue;
                    }
                    let of = |kind| f64::from(u8::from(end == kind));
                    let episode = [
                        1.0,
                        of(termination::SUCCESS),
                        of(termination::FAILED),
                        of(termination::TRUNCATED),
                        std::mem::take(&mut lengths[env]),
                        std::mem::take(&mut returns[env]),
                    ];
                    sums.iter_mut()
                        .zip(episode)
                        .for_each(|(sum, own)| *sum += own);
                }
                let stats = player.stats();
                for (name, want) in STAT_NAMES.into_iter().zip(sums) {
                    let got = stats.sum(name);
                    let bar = if name == "returns" {
                        1e-4 * want.abs().max(1.0)
                    } else {
                        0.0
                    };
                    assert!((got - want).abs() <= bar, "{name}: {got} instead of {want}");
                }
                assert!(
                    player.stats().iter().all(|(_, sum)| sum == 0.0),
                    "read once"
                );
            }
        }
    }
}
