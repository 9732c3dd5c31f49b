//! Episodes that begin because somebody asks for it.
//! Oracle: the state before, and what is drawn on the other device. Bar: equal.

use super::player::{Player, devices};
use super::{config, tasks};
use crate::support::inputs::Draw;
use footwork::env::EnvBatch;
use footwork::gpu::Array;
use footwork::kernels::locomotion::locomotion_layout::{state_f32, state_u32};

const ENVS: usize = 70;

fn restart(envs: &mut EnvBatch, which: &[bool]) {
    let mut first = 0;
    for part in &mut envs.parts {
        let count = part.spec().envs;
        part.restart(&which[first..first + count])
            .expect("a device");
        first += count;
    }
}

#[test]
fn a_restart_begins_full_episodes_where_it_is_asked_for() {
    let which: Vec<bool> = (0..ENVS).map(|env| env % 3 == 0).collect();
    for task in tasks() {
        let drawn = devices().map(|device| {
            let mut player = Player::open(&device, &config(task, ENVS), 4);
            let mut draw = Draw::new(8);
            for _ in 0..4 {
                let action = player.actions(&mut draw);
                player.step(&action);
            }
            let before = player.state();
            restart(&mut player.envs, &which);
            let after = player.state();
            restart(&mut player.envs, &which);
            let again = player.state();
            let mut drawn = Vec::new();
            for (env, &restarted) in which.iter().enumerate() {
                let real = |state: &[f32], field: usize| state[field * ENVS + env];
                let whole = |state: &[u32], field: usize| state[field * ENVS + env];
                if restarted {
                    assert_eq!(whole(&after.state_u32, state_u32::EPISODE_STEP), 0);
                    let limit = whole(&after.state_u32, state_u32::EPISODE_LIMIT);
                    assert_eq!(limit, task.max_steps());
                    assert_eq!(real(&after.state_f32, state_f32::RETURN), 0.0);
                    let target = real(&after.state_f32, state_f32::TARGET_X);
                    assert_ne!(target, real(&again.state_f32, state_f32::TARGET_X));
                    drawn.push((whole(&after.state_u32, state_u32::FRAME), target));
                } else {
                    for field in 0..state_f32::FIELDS {
                        assert_eq!(
                            real(&after.state_f32, field),
                            real(&before.state_f32, field)
                        );
                    }
                    for field in 0..state_u32::FIELDS {
                        assert_eq!(
                            whole(&after.state_u32, field),
                            whole(&before.state_u32, field)
                        );
                    }
                }
            }
            let ended = |state: &[u32]| state[state_u32::EPISODES * ENVS..][..ENVS].to_vec();
            assert_eq!(
                ended(&again.state_u32),
                ended(&before.state_u32),
                "none has ended"
            );
            drawn
        });
        assert_eq!(drawn[0], drawn[1]);
    }
}

#[test]
fn rows_add_up_to_the_statistics() {
    for task in tasks() {
        let mut player = Player::open(&devices()[0], &config(task, ENVS), 30);
        let mut draw = Draw::new(9);
        for _ in 0..30 {
            let action = player.actions(&mut draw);
            player.step(&action);
        }
        let names = player.envs.stat_names();
        let parts = player.envs.parts.iter();
        let rows: Vec<Array> = parts.map(|part| part.row_stats().expect("sums")).collect();
        let stats = player.stats();
        assert!(stats.sum("episodes") > 0.0);
        for (at, (name, sum)) in stats.iter().enumerate() {
            let of_part = |part: &Array| {
                let rows = part.len() / names.len();
                let own = &part.host()[at * rows..][..rows];
                own.iter().map(|&own| f64::from(own)).sum::<f64>()
            };
            let rows: f64 = rows.iter().map(of_part).sum();
            assert!(
                (rows - sum).abs() <= 1e-4 * sum.abs(),
                "{name}: {rows} {sum}"
            );
        }
    }
}
