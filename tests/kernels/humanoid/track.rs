//! The kernels of the task `track`.
//! Oracle: the twins, which are what the CPU plays with; DeepMimic's terms by hand. Bar: a few roundings.

use crate::inputs::{Draw, POISON, close};
use crate::physics::worlds::{Worlds, random_state};
use footwork::env::humanoid::task::KEY_BODIES;
use footwork::kernels::humanoid::draw_starts::start_of;
use footwork::kernels::humanoid::track_reward::{KEYS, TrackedBody, step};
use footwork::kernels::humanoid::track_state::{LAST, ROW, TRACK_STATE};
use footwork::kernels::humanoid::{begin_track, track_observe, track_reward};
use footwork::kernels::termination::{FAILED, RUNNING, TRUNCATED};
use footwork::physics::kinematics::kinematics;
use footwork::physics::model::Model;
use footwork::physics::pose::Pose;
use footwork::physics::scenes;
use footwork::physics::spatial::Spatial;
use glam::{Quat, Vec3};

const ROWS: usize = 9;

/// Rows of random states, some of them the worlds' own.
fn references(worlds: &Worlds, draw: &mut Draw) -> Vec<f32> {
    let mut rows = Vec::new();
    for row in 0..ROWS {
        let mut state = random_state(&worlds.model, draw);
        if row % 2 == 0 {
            for (index, value) in state.q.iter_mut().chain(&mut state.v).enumerate() {
                *value = worlds.state[index * worlds.envs + row % worlds.envs];
            }
        }
        rows.extend(state.q);
        rows.extend(state.v);
        rows.extend(draw.normals(3 * KEYS));
    }
    rows
}

/// Rows that a world is at, with one to go on to.
fn states(envs: usize) -> Vec<f32> {
    let mut states = vec![0.0; TRACK_STATE * envs];
    for env in 0..envs {
        states[ROW * envs + env] = (env % (ROWS - 1)) as f32;
        states[LAST * envs + env] = (env % (ROWS - 1)) as f32 + [1.0, 2.0][env % 2];
    }
    states
        .iter()
        .map(|row| row.min(ROWS as f32 - 1.0))
        .collect()
}

fn params(model: &Model, envs: usize) -> track_reward::Params {
    let keys = KEY_BODIES.map(|name| model.body(name).expect("a body") as u32);
    track_reward::Params {
        envs: envs as u32,
        at: 3,
        nq: model.nq() as u32,
        nv: model.nv() as u32,
        right_hand: keys[0],
        left_hand: keys[1],
        right_foot: keys[2],
        left_foot: keys[3],
        max_distance: 0.5,
    }
}

#[test]
fn rewards_agree() {
    let mut draw = Draw::new(1);
    for envs in [1, 7, 65] {
        let worlds = Worlds::new(scenes::humanoid(), envs, 5);
        let references = references(&worlds, &mut draw);
        let params = params(&worlds.model, envs);
        let forms = forms!(
            track_reward, TRACK_REWARD, envs, params;
            &worlds.model => worlds.model_table, worlds.state, worlds.poses, references,
            mut states(envs), out 3 + envs, out 2 * envs, mut vec![0u32; envs]
        );
        type Outputs = (Vec<f32>, Vec<f32>, Vec<f32>, Vec<u32>);
        let twin: &Outputs = &forms.twin;
        for (form, got) in forms.shaders() {
            close(form, &got.0, &twin.0, |_| 0.0);
            close(form, &got.1, &twin.1, |_| 1e-4);
            close(form, &got.2, &twin.2, |_| 1e-5);
            assert_eq!(got.3, twin.3, "{form}");
        }
        assert!(
            envs < 60
                || [RUNNING, TRUNCATED, FAILED]
                    .iter()
                    .all(|end| twin.3.contains(end))
        );
    }
}

#[test]
fn observations_agree() {
    let mut draw = Draw::new(2);
    for envs in [1, 7, 65] {
        let worlds = Worlds::new(scenes::humanoid(), envs, 6);
        let model = &worlds.model;
        let references = references(&worlds, &mut draw);
        let (dim, width) = (track_observe::dim(model), track_observe::dim(model) + 5);
        let termination: Vec<u32> = (0..envs as u32).map(|env| env % 4).collect();
        for only in [u32::MAX, 1 << TRUNCATED] {
            let params = track_observe::Params {
                envs: envs as u32,
                at: 2,
                width: width as u32,
                only,
                nq: model.nq() as u32,
                nv: model.nv() as u32,
            };
            let forms = forms!(
                track_observe, TRACK_OBSERVE, envs, params;
                model => worlds.model_table, worlds.poses, references, states(envs), termination,
                out 2 + envs * width
            );
            for (form, observation) in forms.shaders() {
                close(form, observation, &forms.twin, |_| 1e-5);
            }
            for (env, row) in forms.twin[2..].chunks_exact(width).enumerate() {
                let observed = only >> termination[env] & 1 == 1;
                assert!(
                    row[..dim]
                        .iter()
                        .all(|&value| (value != POISON) == observed)
                );
                assert!(row[dim..].iter().all(|&value| value == POISON));
            }
        }
    }
}

#[test]
fn starts_agree() {
    let rows: Vec<u32> = (0..40).collect();
    for envs in [1, 7, 65] {
        let params = begin_track::Params {
            envs: envs as u32,
            first: 4,
            seed: 9,
            reset_counter: 2,
            count: 20,
        };
        let mask: Vec<u32> = (0..envs).map(|env| u32::from(env % 3 > 0)).collect();
        let before = vec![7.0f32; TRACK_STATE * envs];
        let forms = forms!(begin_track, BEGIN_TRACK, envs, params; mask, rows, mut before);
        for (form, state) in forms.shaders() {
            close(form, state, &forms.twin, |_| 0.0);
        }
        for (env, &begins) in mask.iter().enumerate() {
            let row = 2.0 * start_of(9, 4 + env as u32, 2, 20) as f32;
            let want = if begins == 0 {
                [7.0; 2]
            } else {
                [row, row + 1.0]
            };
            assert_eq!([0, 1].map(|field| forms.twin[field * envs + env]), want);
        }
    }
}

/// Who is where it should be gets all there is; every term falls with its own error.
#[test]
fn rewards_by_terms() {
    let model = scenes::humanoid();
    let poses_at = |q: &[f32]| {
        let mut poses = vec![Pose::default(); model.bodies.len()];
        kinematics(&model, q, &mut poses, &mut vec![Spatial::ZERO; model.nv()]);
        poses
    };
    let q = model.qpos0.clone();
    let v = vec![0.1; model.nv()];
    let poses = poses_at(&q);
    let keys = KEY_BODIES.map(|name| poses[model.body(name).unwrap()].position.to_array());
    let row = [&q[..], &v, &keys.concat()].concat();
    let references = row.repeat(3);
    let of = |q: &[f32], v: &[f32], poses: &[Pose]| {
        let mut state = [0.0, 2.0];
        let mut measures = [0.0; 2];
        let body = TrackedBody {
            model: &model,
            q,
            v,
            poses,
        };
        step(
            &body,
            &references,
            &mut state,
            &mut measures,
            &params(&model, 1),
        )
    };
    let best = of(&q, &v, &poses);
    assert!((best.0 - 1.0).abs() < 1e-3 && best.1 == RUNNING, "{best:?}");
    let faster: Vec<f32> = v.iter().map(|v| v + 1.0).collect();
    let joints = (model.nv() - 6) as f32;
    let want = 0.9 + 0.1 * (-0.1 * joints).exp();
    assert!((of(&q, &faster, &poses).0 - want).abs() < 1e-3);
    // A hand 0.1 m off.
    let mut moved = poses.clone();
    moved[model.body("right_hand").unwrap()].position += Vec3::X * 0.1;
    let want = 0.85 + 0.15 * (-40.0f32 * 0.01).exp();
    assert!((of(&q, &v, &moved).0 - want).abs() < 1e-3);
    // A ball joint turned by 0.5 rad: its quaternion's sign does not matter.
    let ball = model
        .joints
        .iter()
        .find(|joint| joint.kind.nq() == 4)
        .unwrap();
    let mut turned = q.clone();
    let [x, y, z, w] = Quat::from_rotation_x(0.5).to_array();
    turned[ball.q..ball.q + 4].copy_from_slice(&[-w, -x, -y, -z]);
    let want = 0.35 + 0.65 * (-2.0f32 * 0.25).exp();
    assert!((of(&turned, &v, &poses).0 - want).abs() < 1e-3);
    // The root half a metre off fails.
    let mut off = q.clone();
    off[0] += 0.6;
    assert_eq!(of(&off, &v, &poses).1, FAILED);
}
