//! The kernels of the tasks `punch` and `joystick`.
//! Oracle: the twins, which are what the CPU plays with, and the paper's cases by hand. Bar: a few roundings.

use crate::inputs::{Draw, SIZES, close, same};
use footwork::kernels::humanoid::punch_reward::{Bodies, far_reward, step};
use footwork::kernels::humanoid::punch_state::{
    FACING, FIRST, FIRST_SPEED, HAND_SPEED, HIT_STEPS, MOVING, PUNCH_STATE,
};
use footwork::kernels::humanoid::{place_target, punch_observe, punch_reward};
use footwork::kernels::physics::smooth_dynamics::POSE_DIM;
use footwork::kernels::termination::{RUNNING, SUCCESS};
use footwork::physics::pose::Pose;
use footwork::physics::spatial::Spatial;
use glam::{Quat, Vec2, Vec3};

/// A pelvis, a right and a left hand, and the target.
fn params(envs: usize) -> punch_reward::Params {
    punch_reward::Params {
        envs: envs as u32,
        at: 3,
        velocities_at: 5,
        bodies: 4,
        own_bodies: 3,
        right_hand: 1,
        left_hand: 2,
        joystick: 0,
        far: 2,
        facing: 1,
        fist_only: 0,
        steps_after: 60,
        speed: 1.2,
        near: 1.2,
        far_weight: 0.3,
        hand_speed: 1.0,
        fist_speed: 3.0,
    }
}

/// Poses of four bodies, with unit rotations and targets near and far, some toppled.
fn poses(draw: &mut Draw, envs: usize) -> Vec<f32> {
    let mut poses = draw.normals(4 * POSE_DIM * envs);
    for env in 0..envs {
        for body in 0..4 {
            let at = |k: usize| (POSE_DIM * body + k) * envs + env;
            let norm = (3..7).map(|k| poses[at(k)].powi(2)).sum::<f32>().sqrt();
            (3..7).for_each(|k| poses[at(k)] /= norm);
        }
    }
    poses
}

fn states(draw: &mut Draw, envs: usize) -> Vec<f32> {
    let mut states = draw.normals(PUNCH_STATE * envs);
    for env in 0..envs {
        states[HIT_STEPS * envs + env] = [0.0, 0.0, 5.0, 60.0][env % 4];
        states[FIRST * envs + env] = [0.0, 1.0, 2.0, 3.0, 0.0][env % 5];
        states[FIRST_SPEED * envs + env] = 2.0 + (env % 3) as f32;
        states[HAND_SPEED * envs + env] = 3.5;
    }
    states
}

/// State, rewards, measures, ends and groups.
type Outputs = (Vec<f32>, Vec<f32>, Vec<f32>, Vec<u32>, Vec<u32>);

#[test]
fn punch_rewards_agree() {
    let mut draw = Draw::new(1);
    for (case, envs) in SIZES.into_iter().cycle().take(12).enumerate() {
        let params = punch_reward::Params {
            joystick: case as u32 % 2,
            far: case as u32 % 4,
            facing: u32::from(case % 4 > 0),
            fist_only: u32::from(case % 5 == 0),
            ..params(envs)
        };
        let poses = poses(&mut draw, envs);
        let dynamics = draw.normals((5 + 24) * envs);
        let mut forces = draw.normals(3 * 7 * envs);
        // Most do not touch.
        forces.iter_mut().enumerate().for_each(|(at, force)| {
            *force *= f32::from(at % envs % 3 == 0 && at / envs / 3 % 2 == 0);
        });
        let state = states(&mut draw, envs);
        let forms = forms!(
            punch_reward, PUNCH_REWARD, envs, params;
            poses, dynamics, forces, mut state, out 3 + envs, out 4 * envs, mut vec![0u32; envs],
            mut vec![7u32; 3 + envs]
        );
        let twin: &Outputs = &forms.twin;
        for (form, got) in forms.shaders() {
            close(form, &got.0, &twin.0, |_| 1e-5);
            close(form, &got.1, &twin.1, |_| 1e-5);
            close(form, &got.2, &twin.2, |_| 1e-3);
            assert_eq!((&got.3, &got.4), (&twin.3, &twin.4), "{form}");
        }
    }
}

#[test]
fn targets_agree_and_stand_where_they_should() {
    for envs in SIZES {
        let params = place_target::Params {
            envs: envs as u32,
            first: 9,
            seed: 2,
            step_counter: 4,
            nq: 14,
            target_q: 7,
            target_v: 6,
            near_share: 0.5,
            near_least: 0.6,
            near_most: 1.2,
            near_bearing: 1.0,
            least: 5.0,
            most: 10.0,
            height: 0.9,
            facing_power: 3.0,
        };
        let mut draw = Draw::new(2);
        let mut starts = draw.normals(26 * envs);
        for env in 0..envs {
            let yaw = Quat::from_rotation_z(draw.within(3.0));
            let q = [yaw.w, yaw.x, yaw.y, yaw.z];
            (0..4).for_each(|k| starts[(3 + k) * envs + env] = q[k]);
        }
        let mask: Vec<u32> = (0..envs).map(|env| u32::from(env % 3 > 0)).collect();
        let forms = forms!(
            place_target, PLACE_TARGET, envs, params;
            mask, mut starts, mut vec![7.0f32; PUNCH_STATE * envs]
        );
        for (form, (starts, state)) in forms.shaders() {
            close(form, starts, &forms.twin.0, |_| 2e-5);
            close(form, state, &forms.twin.1, |_| 1e-5);
        }
        let (placed, state): &(Vec<f32>, Vec<f32>) = &forms.twin;
        for env in 0..envs {
            let at = |field: usize| placed[field * envs + env];
            let carried = |field: usize| state[field * envs + env];
            if mask[env] == 0 {
                assert_eq!(at(7), starts[7 * envs + env]);
                continue;
            }
            let gap = Vec2::new(at(7) - at(0), at(8) - at(1));
            let distance = gap.length();
            let near = (0.599..1.201).contains(&distance);
            assert!(near || (4.999..10.001).contains(&distance), "{distance} m");
            let forward = Quat::from_xyzw(at(4), at(5), at(6), at(3)) * Vec3::X;
            let angle = forward.truncate().angle_to(gap).abs();
            assert!(!near || angle < 1.001, "{angle} rad from the heading");
            let moving = Vec2::new(carried(MOVING), carried(MOVING + 1));
            assert!((moving - gap / distance).length() < 1e-4);
            let facing = Vec2::new(carried(FACING), carried(FACING + 1));
            assert!((facing.length() - 1.0).abs() < 1e-5);
            assert_eq!((carried(HIT_STEPS), carried(FIRST)), (0.0, 0.0));
            assert!((0..6).all(|k| at(14 + 6 + k) == 0.0), "it stands still");
        }
    }
}

#[test]
fn punch_observations_agree() {
    let mut draw = Draw::new(3);
    for (case, envs) in SIZES.into_iter().cycle().take(10).enumerate() {
        let joystick = case % 2 == 0;
        let dim = punch_observe::dim(joystick);
        let params = punch_observe::Params {
            envs: envs as u32,
            at: 4,
            width: 30,
            only: 1 << RUNNING | 1 << SUCCESS,
            velocities_at: 5,
            target_body: 3,
            joystick: u32::from(joystick),
        };
        let poses = poses(&mut draw, envs);
        let dynamics = draw.normals((5 + 24) * envs);
        let state = states(&mut draw, envs);
        let termination: Vec<u32> = (0..envs as u32).map(|env| env % 3).collect();
        let forms = forms!(
            punch_observe, PUNCH_OBSERVE, envs, params;
            poses, dynamics, state, termination, out 4 + 30 * envs
        );
        for (form, observation) in forms.shaders() {
            close(form, observation, &forms.twin, |_| 1e-5);
        }
        let row = &forms.twin[4..34];
        assert_eq!(
            row[dim],
            crate::inputs::POISON,
            "only its own numbers are written"
        );
        assert!(row[..dim].iter().all(|value| value.abs() < 100.0));
    }
    same("nothing", &[], &[]);
}

/// A world whose root faces x, with the target so far away along x.
struct World {
    poses: [Pose; 4],
    velocities: [Spatial; 4],
    touching: [Vec3; 3],
}

impl World {
    fn new(distance: f32) -> World {
        let at = |x: f32, z: f32| Pose {
            position: Vec3::new(x, 0.0, z),
            rotation: Quat::IDENTITY,
        };
        World {
            poses: [at(0.0, 0.9), at(0.3, 1.4), at(0.3, 1.4), at(distance, 0.9)],
            velocities: [Spatial::ZERO; 4],
            touching: [Vec3::ZERO; 3],
        }
    }

    fn step(&self, state: &mut [f32], params: &punch_reward::Params) -> (f32, u32, [f32; 4]) {
        let bodies = Bodies {
            poses: &self.poses,
            velocities: &self.velocities,
            touching: &self.touching,
        };
        let mut measures = [0.0; 4];
        let (reward, end, group) = step(&bodies, state, &mut measures, params);
        assert!(group < 3 && (group == 2) == (state[HIT_STEPS] > 0.0));
        (reward, end, measures)
    }
}

/// The paper's cases: 1.4 for a hit, 0.3 to 0.6 near, 0 to 0.3 far.
#[test]
fn rewards_by_cases() {
    let params = params(1);
    let mut state = [0.0; PUNCH_STATE];
    let (near, end, _) = World::new(0.7).step(&mut state, &params);
    assert!((0.3..=0.6).contains(&near) && end == RUNNING, "{near}");
    let mut punching = World::new(0.7);
    punching.velocities[1].linear = Vec3::X * 5.0;
    let (punch, ..) = punching.step(&mut [0.0; PUNCH_STATE], &params);
    assert!(punch > near + 0.2, "{punch} {near}");
    let (far, _, measures) = World::new(5.0).step(&mut [0.0; PUNCH_STATE], &params);
    assert!((0.0..=0.3).contains(&far) && measures[2] == 1.0, "{far}");
    let mut toppled = World::new(1.0);
    toppled.poses[3].rotation = Quat::from_rotation_y(1.5);
    let mut state = [0.0; PUNCH_STATE];
    let (hit, end, measures) = toppled.step(&mut state, &params);
    assert_eq!(
        (hit, end, measures[0], state[HIT_STEPS]),
        (1.4, RUNNING, 1.0, 1.0)
    );
    // It goes on for the wanted time, and counts once.
    for step in 1..60 {
        let (hit, end, measures) = toppled.step(&mut state, &params);
        assert_eq!((hit, end, measures[0]), (1.4, RUNNING, 0.0), "{step}");
    }
    assert_eq!(toppled.step(&mut state, &params).1, SUCCESS);
}

/// As printed, the distance factor is nothing at 5 m.
#[test]
fn far_rewards_as_printed_and_repaired() {
    let of = |far: u32, distance: f32, velocity: Vec2, alignment: f32| {
        let params = punch_reward::Params { far, ..params(1) };
        far_reward(distance, Vec2::X, velocity, alignment, &params)
    };
    let wanted = Vec2::X * 1.2;
    assert!(of(0, 5.0, wanted, 1.0) < 1e-10);
    assert!((of(0, 0.0, wanted, 1.0) - 1.0).abs() < 1e-6);
    assert!((of(1, 5.0, wanted, 1.0) - 1.0 / 6.0).abs() < 1e-6);
    // The sum has a slope everywhere: nearer, faster, better turned.
    let sum = of(2, 5.0, Vec2::ZERO, 0.0);
    assert!(of(2, 4.0, Vec2::ZERO, 0.0) > sum);
    assert!(of(2, 5.0, Vec2::X * 0.1, 0.0) > sum && of(2, 5.0, -Vec2::X * 0.1, 0.0) < sum);
    assert!(of(2, 5.0, Vec2::ZERO, 0.1) > sum && of(2, 5.0, Vec2::ZERO, -0.1) < sum);
    // So has that of a velocity, which wants no more than the wanted speed, and the wanted direction.
    let still = of(3, 5.0, Vec2::ZERO, 0.0);
    assert!(of(3, 4.0, Vec2::ZERO, 0.0) > still);
    assert!(of(3, 5.0, Vec2::X * 0.1, 0.0) > still && of(3, 5.0, -Vec2::X * 0.1, 0.0) < still);
    assert!(of(3, 5.0, Vec2::ZERO, 0.1) > still && of(3, 5.0, Vec2::ZERO, -0.1) < still);
    let best = of(3, 5.0, wanted, 1.0);
    for other in [Vec2::X * 1.1, Vec2::X * 1.3, Vec2::new(1.2, 0.1)] {
        assert!(of(3, 5.0, other, 1.0) < best, "{other}");
    }
    for far in 0..4 {
        for speed in [-3.0, 0.0, 1.2, 9.0] {
            for alignment in [-1.0, 0.0, 1.0] {
                let reward = of(far, 3.0, Vec2::X * speed, alignment);
                assert!((-0.2..=1.0).contains(&reward), "{reward}");
            }
        }
    }
}

/// Equation 10 over eight headings: most for facing the wanted way, and falling with the angle.
#[test]
fn facing_over_eight_headings() {
    let facing = |eighth: usize| {
        let alignment = (std::f32::consts::FRAC_PI_4 * eighth as f32).cos();
        let params = punch_reward::Params {
            far: 0,
            ..params(1)
        };
        far_reward(0.0, Vec2::X, Vec2::X * 1.2, alignment, &params)
    };
    for eighth in 0..8 {
        let alignment = (std::f64::consts::FRAC_PI_4 * eighth as f64).cos();
        let want = (-5.0 * (alignment - 1.0).abs()).exp();
        assert!((f64::from(facing(eighth)) - want).abs() < 1e-5, "{eighth}");
    }
    assert!(facing(0) > facing(1) && facing(1) > facing(2) && facing(2) > facing(4));
    assert!((facing(1) - facing(7)).abs() < 1e-5);
}

/// A shove topples the target, but is no punch.
#[test]
fn only_a_first_contact_of_a_fast_hand_is_a_fist() {
    let params = punch_reward::Params {
        fist_only: 1,
        ..params(1)
    };
    for (speed, body, fist) in [(4.0, 1, true), (2.0, 1, false), (4.0, 0, false)] {
        let mut world = World::new(0.8);
        let mut state = [0.0; PUNCH_STATE];
        world.velocities[1].linear = Vec3::X * speed;
        world.step(&mut state, &params);
        world.velocities[1].linear = Vec3::ZERO;
        world.touching[body] = Vec3::X;
        world.step(&mut state, &params);
        assert_eq!(state[FIRST], body as f32 + 1.0);
        assert_eq!(state[FIRST_SPEED], speed);
        world.touching[body] = Vec3::ZERO;
        // Who touches later does not count.
        world.touching[2] = Vec3::X;
        world.poses[3].rotation = Quat::from_rotation_x(1.5);
        let (_, _, measures) = world.step(&mut state, &params);
        let want = f32::from(u8::from(fist));
        assert_eq!(
            (measures[0], measures[1]),
            (want, want),
            "{speed} m/s, body {body}"
        );
    }
}
