//! Environments that were saved and go on elsewhere.
//! Oracle: those that never stopped. Bar: equal bit for bit.

use super::player::{Player, devices};
use super::{config, tasks};
use crate::support::inputs::Draw;
use footwork::container::Section;
use footwork::env::locomotion::{LocomotionTask, Obstacles, Plane};
use footwork::gpu::Device;

const ENVS: usize = 70;
const STEPS: usize = 20;

#[test]
fn what_was_saved_goes_on_as_if_it_had_never_stopped() {
    for device in devices() {
        for task in tasks() {
            let config = config(task, ENVS);
            let mut whole = Player::open(&device, &config, STEPS);
            let mut draw = Draw::new(5);
            for _ in 0..STEPS {
                let action = whole.actions(&mut draw);
                whole.step(&action);
            }
            let mut resumed = Player::open(&device, &config, STEPS);
            resumed.load(whole.save()).expect("such environments");
            assert_eq!(resumed.state(), whole.state());
            for _ in 0..STEPS {
                let action = whole.actions(&mut draw);
                whole.step(&action);
                resumed.step(&action);
            }
            assert_eq!(resumed.state(), whole.state());
            assert_eq!(resumed.observation(), whole.observation());
            assert_eq!(resumed.rewards(), whole.rewards());
            assert_eq!(resumed.terminations(), whole.terminations());
            assert_eq!(resumed.final_observations(), whole.final_observations());
            assert_eq!(resumed.stats(), whole.stats());
        }
    }
}

/// What is not of these environments is refused in words.
#[test]
fn the_state_of_other_environments_is_refused() {
    let plane = LocomotionTask::Plane(Plane::default());
    let obstacles = LocomotionTask::Obstacles(Obstacles::PRINTED);
    for device in devices() {
        let refused = |of: LocomotionTask, envs: usize| {
            let saved = Player::together(&device, &config(of, envs), 1).save();
            let mut player = Player::together(&device, &config(plane, ENVS), 1);
            player.load(saved).expect_err("others").to_string()
        };
        assert!(refused(plane, ENVS - 1).contains("state_f32"));
        assert!(refused(obstacles, ENVS).contains("boxes"));
        let mut player = Player::together(&device, &config(plane, ENVS), 1);
        let empty = vec![("envs.0".to_string(), Section::default())];
        let error = player.load(empty).expect_err("nothing in it").to_string();
        assert!(error.contains("step_counter"), "{error}");
    }
}

/// A state that shows a frame the database does not have.
#[test]
fn frames_of_another_database_are_refused() {
    let player = Player::together(&Device::Cpu, &config(tasks()[0], 3), 1);
    let mut state = player.state();
    state.state_u32[1] = 1_000_000;
    let mut section = Section::default();
    state.save(&mut section);
    let mut player = Player::together(&Device::Cpu, &config(tasks()[0], 3), 1);
    let error = player.load(vec![("envs.0".to_string(), section)]);
    let error = error.expect_err("no such frame").to_string();
    assert!(error.contains("frame 1000000"), "{error}");
}
