//! Kernels of the tasks of the simulated humanoid.
//! Oracle: the twins, which are what the CPU plays with. Bar: what is drawn or counted equal bit for bit;
//! else a few roundings.

mod boxing;
mod punch;
mod track;

use crate::inputs::{Draw, POISON, SIZES, close, same};
use end_episode::fields;
use footwork::kernels::humanoid::{
    action_targets, draw_starts, end_episode, episode_sums, random_pushes, stand_reward,
};
use footwork::kernels::physics::smooth_dynamics::POSE_DIM;
use footwork::kernels::termination::{FAILED, LEADS, RUNNING, SUCCESS, TRUNCATED};

#[test]
fn action_targets_agree() {
    let mut draw = Draw::new(1);
    for envs in SIZES {
        let (driven, at) = (28, 5);
        let params = action_targets::Params {
            envs: envs as u32,
            driven: driven as u32,
            at: at as u32,
        };
        let action = draw.normals(at + driven * envs);
        let scale = draw.normals(2 * driven);
        let groups = [envs.div_ceil(64) as u32, driven as u32, 1];
        let forms = forms!(
            action_targets, ACTION_TARGETS, groups, params; action, scale, out driven * envs
        );
        for (form, targets) in forms.shaders() {
            close(form, targets, &forms.twin, |_| 1e-6);
        }
        // Beyond one counts as one.
        for (index, target) in forms.twin.iter().enumerate() {
            let (drive, env) = (index / envs, index % envs);
            let most = scale[drive].abs() + scale[driven + drive].abs() + 1e-6;
            assert!(target.abs() <= most, "drive {drive} of {env}");
        }
    }
}

#[test]
fn pushes_agree_and_come_every_one_to_two_seconds() {
    let (bodies, envs) = (3, 65);
    let mut last = vec![None; envs];
    let mut gaps = Vec::new();
    for step_counter in 0..300 {
        let params = random_pushes::Params {
            envs: envs as u32,
            first: 7,
            seed: 3,
            step_counter,
            interval: 45,
            jitter: 15,
            body: 1,
            min_force: 100.0,
            max_force: 200.0,
        };
        let forces = vec![POISON; 6 * bodies * envs];
        let mut twin = forces.clone();
        random_pushes::twin(&mut twin, &params);
        // Shaders now and then: lavapipe compiles for each step.
        if step_counter % 50 < 16 {
            let forms = forms!(random_pushes, RANDOM_PUSHES, envs, params; mut forces);
            for (form, forces) in forms.shaders() {
                close(form, forces, &forms.twin, |_| 1e-3);
            }
        }
        let horizontal = 9 * envs..11 * envs;
        for (index, force) in twin.iter().enumerate() {
            assert_eq!(!horizontal.contains(&index), *force == POISON, "{index}");
        }
        for (env, last) in last.iter_mut().enumerate() {
            let [x, y] = [9, 10].map(|field| twin[field * envs + env]);
            if x == 0.0 && y == 0.0 {
                continue;
            }
            assert!((99.9..200.1).contains(&x.hypot(y)), "{x} {y}");
            gaps.extend(last.map(|last| step_counter - last));
            *last = Some(step_counter);
        }
    }
    let (least, most) = (gaps.iter().min().unwrap(), gaps.iter().max().unwrap());
    assert!(*least >= 30 && *most <= 60, "{least} to {most} steps apart");
    assert!(gaps.len() > 4 * envs);
}

#[test]
fn starts_agree() {
    let mut draw = Draw::new(2);
    for envs in SIZES {
        let (count, positions, velocities, agents) = (10, 4, 3, 1 + envs % 2);
        let width = positions + velocities;
        let params = draw_starts::Params {
            envs: envs as u32,
            agents: agents as u32,
            first: 3,
            seed: 4,
            reset_counter: 9,
            count: count as u32,
            positions: positions as u32,
            velocities: velocities as u32,
        };
        let mask: Vec<u32> = (0..envs as u32).map(|env| env % 3).collect();
        let states = draw.normals(count * width);
        let forms =
            forms!(draw_starts, DRAW_STARTS, envs, params; mask, states, out agents * width * envs);
        for (form, starts) in forms.shaders() {
            same(form, starts, &forms.twin);
        }
        for env in 0..envs {
            assert_eq!(forms.twin[env] == POISON, env % 3 == 0);
            for agent in (0..agents).filter(|_| env % 3 > 0) {
                let q = (0..positions).map(|k| agent * positions + k);
                let v = (0..velocities).map(|k| agents * positions + agent * velocities + k);
                let fields = q.chain(v).map(|field| forms.twin[field * envs + env]);
                let drawn: Vec<f32> = fields.collect();
                let mut all = states.chunks_exact(width);
                assert!(all.any(|state| state == drawn), "agent {agent} of {env}");
            }
        }
    }
}

#[test]
fn sums_agree_and_start_anew() {
    let mut draw = Draw::new(3);
    for envs in SIZES {
        let (fields, start) = (5, 2);
        let params = episode_sums::Params {
            envs: envs as u32,
            start: start as u32,
            fields: (fields - start) as u32,
        };
        let values = draw.normals(fields * envs);
        let groups = [(fields - start) as u32, 1, 1];
        let forms = forms!(
            episode_sums, EPISODE_SUMS, groups, params; mut values, out fields - start
        );
        for (form, (values, sums)) in forms.shaders() {
            same(form, values, &forms.twin.0);
            close(form, sums, &forms.twin.1, |_| 1e-6 * envs as f32);
        }
        let twin: &Vec<f32> = &forms.twin.0;
        assert!(twin[start * envs..].iter().all(|&value| value == 0.0));
    }
}

#[test]
fn stand_reward_agrees() {
    let mut draw = Draw::new(4);
    for envs in SIZES {
        let params = stand_reward::Params {
            envs: envs as u32,
            at: 4,
            nq: 12,
            nv: 11,
            torso: 2,
            alive_reward: 0.3,
            upright_reward: 0.5,
            stillness_reward: 0.2,
        };
        let state = draw.normals(23 * envs);
        let poses = draw.normals(5 * POSE_DIM * envs);
        let forms = forms!(
            stand_reward, STAND_REWARD, envs, params; state, poses, out 4 + envs, out envs
        );
        for (form, got) in forms.shaders() {
            close(form, &got.0, &forms.twin.0, |_| 1e-5);
            close(form, &got.1, &forms.twin.1, |_| 1e-5);
        }
    }
}

fn end_params(envs: usize, agents: usize, measures: usize) -> end_episode::Params {
    end_episode::Params {
        envs: envs as u32,
        agents: agents as u32,
        at: 4,
        nq: 12,
        nv: 11,
        bodies: 5,
        head: 1,
        pelvis: 0,
        right_foot: 3,
        left_foot: 4,
        measures: measures as u32,
        max_steps: 300,
        successes: 1 << SUCCESS | 1 << TRUNCATED,
        falls_end: agents as u32 % 2,
        min_head: 0.9,
        min_pelvis: 0.5,
        min_body: 0.15,
        max_speed: 1000.0,
    }
}

#[test]
fn ends_agree() {
    let mut draw = Draw::new(5);
    let cases = SIZES.into_iter().zip([0, 1, 2, 5].into_iter().cycle());
    for ((envs, measures), agents) in cases.flat_map(|case| [(case, 1), (case, 2)]) {
        let (params, rows) = (end_params(envs, agents, measures), envs * agents);
        let mut state = draw.normals(23 * envs);
        // Some diverge.
        for env in (0..envs).step_by(7) {
            let worst = [f32::NAN, f32::INFINITY, 1e4][env % 3];
            state[(12 + env % 11) * envs + env] = worst;
        }
        let mut poses = draw.normals(11 * POSE_DIM * envs);
        for body in 0..11 {
            for env in 0..envs {
                // Most stand.
                poses[(POSE_DIM * body + 2) * envs + env] = 1.2 + 0.3 * draw.normal();
            }
        }
        let leads = |row: usize| LEADS * u32::from(row % 4 == 3);
        let task_end: Vec<u32> = (0..rows)
            .map(|row| u32::from(row / agents % 6 == 5) + leads(row))
            .collect();
        let mut episode = draw.normals(fields(measures) * rows);
        for row in 0..rows {
            // Step and limit.
            episode[row] = (row / agents % 5) as f32;
            episode[rows + row] = 4.0;
        }
        let reward = draw.normals(4 + rows);
        let measured = draw.normals(measures.max(1) * rows);
        let forms = forms!(
            end_episode, END_EPISODE, envs, params;
            state, poses, measured, task_end, mut episode, mut reward,
            mut vec![9u32; 4 + rows], out envs
        );
        let twin: &(Vec<f32>, Vec<f32>, Vec<u32>, Vec<u32>) = &forms.twin;
        for (form, got) in forms.shaders() {
            close(form, &got.0, &twin.0, |_| 1e-5);
            same(form, &got.1, &twin.1);
            assert_eq!((&got.2, &got.3), (&twin.2, &twin.3), "{form}");
        }
        for row in 0..rows {
            assert_eq!(twin.2[4 + row], twin.3[row / agents]);
            if row / agents % 7 == 0 {
                assert_eq!((twin.1[4 + row], twin.2[4 + row]), (0.0, FAILED));
            }
        }
        if envs == 1000 {
            for end in [RUNNING, SUCCESS, TRUNCATED, FAILED] {
                assert!(twin.3.contains(&end), "{end}");
            }
        }
    }
}
