//! Levels: episodes that begin are of the level that holds then, and running ones stay as they are.

use super::config;
use super::player::{Player, devices};
use crate::support::inputs::Draw;
use footwork::env::Stats;
use footwork::env::locomotion::{EnvConfig, LocomotionTask, Obstacles, STAT_NAMES};
use footwork::kernels::locomotion::locomotion_layout::state_u32;

const ENVS: usize = 60;
const TASK: Obstacles = Obstacles {
    count: 3,
    curriculum: true,
    speed: 9.0,
    max_steps: 12,
    ..Obstacles::PRINTED
};

/// The largest speed of an environment's obstacles, m/s.
fn speed(player: &Player, env: usize) -> f32 {
    let count = TASK.count as usize;
    let state = player.state();
    let [x, z] = [0, 1].map(|axis| &state.obstacle_velocity[(2 * env + axis) * count..][..count]);
    let speeds = x.iter().zip(z).map(|(x, z)| x.hypot(*z));
    speeds.fold(0.0, f32::max)
}

/// So many successes of 1000 episodes.
fn stats(successes: f32) -> Stats {
    Stats::new(
        &STAT_NAMES,
        &[1000.0, successes, 0.0, 1000.0 - successes, 9000.0, 0.0],
    )
}

#[test]
fn a_passed_level_holds_for_episodes_that_begin() {
    for device in devices() {
        let config = EnvConfig {
            level: 0,
            ..config(LocomotionTask::Obstacles(TASK), ENVS)
        };
        let mut player = Player::open(&device, &config, 4);
        player.envs.advance_curriculum(&stats(0.0));
        assert_eq!(player.state().level, 0);
        assert!(
            (0..ENVS).all(|env| speed(&player, env) == 0.0),
            "the first stands"
        );
        player.envs.advance_curriculum(&stats(1000.0));
        player.envs.advance_curriculum(&stats(1000.0));
        assert_eq!(player.state().level, 2);

        let mut draw = Draw::new(1);
        let mut begun = [false; ENVS];
        for _ in 0..8 {
            let action = player.actions(&mut draw);
            player.step(&action);
            let state = player.state();
            for (env, begun) in begun.iter_mut().enumerate() {
                *begun |= state.state_u32[state_u32::EPISODE_STEP * ENVS + env] == 0;
                // 9 m/s on the tenth level.
                let wanted = if *begun { 2.0 } else { 0.0 };
                assert!((speed(&player, env) - wanted).abs() < 1e-5, "{env}");
            }
        }
        let count = begun.iter().filter(|&&begun| begun).count();
        assert!((1..ENVS).contains(&count), "{count} began");

        let mut resumed = Player::open(&device, &config, 4);
        assert_eq!(resumed.state().level, 0);
        resumed.load(player.save()).expect("such environments");
        assert_eq!(resumed.state(), player.state());
        resumed.envs.advance_curriculum(&stats(1000.0));
        assert_eq!(resumed.state().level, 3);
    }
}
