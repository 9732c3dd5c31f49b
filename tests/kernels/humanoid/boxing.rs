//! The kernels of the task `box`.
//! Oracle: the twins, which are what the CPU plays with, and the paper's equations by hand. Bar: a few roundings.

use crate::inputs::{Draw, SIZES, close};
use footwork::kernels::humanoid::boxing_reward::{FighterStep, MEASURES, PAIRS, Params, step};
use footwork::kernels::humanoid::boxing_state::{
    CLINCH_STEPS, DAMAGE, DOWN, JOINT_SPEEDS, KNOCKDOWNS, SQUARED_ACCELERATION, STAGGER_STEPS,
    state_dim,
};
use footwork::kernels::humanoid::boxing_terms as terms;
use footwork::kernels::humanoid::fighters::Fighters;
use footwork::kernels::humanoid::place_fighters::MARGIN;
use footwork::kernels::humanoid::{
    boxing_observe, boxing_reward, joint_accelerations, place_fighters,
};
use footwork::kernels::physics::smooth_dynamics::POSE_DIM;
use footwork::kernels::termination::{FAILED, LEADS, RUNNING, SUCCESS, TRUNCATED};
use footwork::physics::pose::Pose;
use footwork::physics::spatial::Spatial;
use glam::{Quat, Vec2, Vec3};
use std::f32::consts::{FRAC_PI_2, PI};

/// Bodies of a fighter: pelvis, torso, head, hands and feet.
const BODIES: usize = 7;
const PELVIS: usize = 0;
const TORSO: usize = 1;
const HEAD: usize = 2;
const RIGHT_HAND: usize = 3;
const LEFT_HAND: usize = 4;

/// The paper's reward.
fn params(envs: usize) -> Params {
    Params {
        envs: envs as u32,
        at: 3,
        velocities_at: 5,
        bodies: BODIES as u32,
        head: HEAD as u32,
        pelvis: PELVIS as u32,
        torso: TORSO as u32,
        right_hand: RIGHT_HAND as u32,
        left_hand: LEFT_HAND as u32,
        right_foot: 5,
        left_foot: 6,
        torso_up: 0.1,
        head_up: 0.2,
        min_head: 0.9,
        min_pelvis: 0.5,
        min_body: 0.15,
        fall_ends: 1,
        facing: 1,
        additive: 0,
        stagger_steps: 0,
        blow_force: 0.0,
        clinch_steps: 3,
        clinch: 0.5,
        arena: 3.0,
        near: 1.75,
        speed: 1.2,
        dt: 1.0 / 30.0,
        damage_scale: 1.0,
        damage_taken: 2.0,
        dense: 1.0,
        knockdown_bonus: 500.0,
        far_weight: 1.0,
        damage_weight: 1.0,
        close_weight: 4.0,
        facing_weight: 10.0,
        fall_weight: 200.0,
        energy_weight: 0.001,
        penalty_weight: 30.0,
    }
}

#[test]
fn terms_are_the_papers() {
    let near = |got: f32, want: f64| assert!((f64::from(got) - want).abs() < 1e-5, "{got} {want}");
    near(terms::far(1.0, 1.0, 1.0), 1.0);
    near(terms::far(0.2, 0.5, 0.25), 0.1 + 0.2 + 0.025);
    near(terms::position(0.0), 1.0);
    near(terms::position(2.0), (-2.0f64).exp());
    near(terms::velocity(1.2, 1.2), 1.0);
    near(terms::velocity(3.0, 1.2), 1.0);
    near(terms::velocity(0.2, 1.2), (-4.0f64).exp());
    near(terms::velocity(-0.8, 1.2), (-16.0f64).exp());
    near(terms::facing_from_afar(0.7), 0.7);
    near(terms::facing_from_afar(-0.7), 0.0);
    near(terms::damage(300.0, 100.0, 2.0), 100.0);
    near(terms::damage(0.0, 90.0, 2.0), -180.0);
    near(terms::damage(0.0, 900.0, 2.0), -200.0);
    near(terms::damage(0.0, 900.0, 0.0), 0.0);
    near(terms::close(Vec3::ZERO, 0.0), 0.2);
    near(terms::close(Vec3::X, 0.5), 0.2 * (-4.0f64).exp() + 0.4);
    near(terms::close(Vec3::X * 9.0, 7.0), 0.8);
    near(terms::close(Vec3::X * 9.0, -7.0), 0.0);
    near(terms::facing(1.0, true), 1.0);
    near(terms::facing(0.5, true), (-2.5f64).exp());
    near(terms::facing(-1.0, true), (-10.0f64).exp());
    near(terms::facing(1.0, false), 0.0);
    near(terms::fall(1.0), 0.0);
    near(terms::fall(0.0), 0.6);
    near(terms::fall(-1.0), 1.2);
    near(terms::nearness(0.4), 1.0);
    near(terms::nearness(1.5), (-2.5f64).exp());
    near(terms::energy(1.5, 200.0), 200.0 * (-2.5f64).exp());
    near(terms::penalty(false, false), 0.0);
    near(terms::penalty(true, true), 2.0);
}

/// Two fighters that stand upright on the x axis, hands at their chests.
struct Ring {
    poses: Vec<Pose>,
    velocities: Vec<Spatial>,
    touching: [Vec3; 2 * PAIRS],
    state: Vec<f32>,
}

impl Ring {
    /// Roots at these places of the x axis, turned by these angles, rad: red faces blue at 0, blue red at pi.
    fn new(at: [f32; 2], yaw: [f32; 2]) -> Ring {
        let heights = [0.9, 1.1, 1.4, 1.2, 1.2, 0.05, 0.05];
        let poses = [0, 1].map(|fighter| {
            heights.map(|height| Pose {
                position: Vec3::new(at[fighter], 0.0, height),
                rotation: Quat::from_rotation_z(yaw[fighter]),
            })
        });
        Ring {
            poses: poses.concat(),
            velocities: vec![Spatial::ZERO; 2 * BODIES],
            touching: [Vec3::ZERO; 2 * PAIRS],
            state: vec![0.0; state_dim(28)],
        }
    }

    fn step(&mut self, params: &Params) -> ([FighterStep; 2], [f32; 2 * MEASURES]) {
        let fighters = Fighters {
            bodies: params.fighter_bodies(),
            poses: &self.poses,
            velocities: &self.velocities,
        };
        let mut measures = [0.0; 2 * MEASURES];
        let steps = step(
            &fighters,
            &self.touching,
            &mut self.state,
            &mut measures,
            params,
        );
        (steps, measures)
    }

    fn rewards(&mut self, params: &Params) -> [f32; 2] {
        self.step(params).0.map(|step| step.reward)
    }

    /// Lays a fighter down.
    fn lay(&mut self, fighter: usize) {
        self.poses[fighter * BODIES + HEAD].position.z = 0.3;
    }
}

/// Table 3 at face to face, 1 m apart, nothing moving: hands are 1 m from the torso's and the head's axis.
fn at_rest() -> f32 {
    // The torso's centre is at 1.2 m, as high as the hands; the head's is at 1.6 m.
    4.0 * 0.2 * (-4.0f32).exp() + 10.0
}

#[test]
fn rewards_of_simple_cases() {
    let near = |got: f32, want: f32| {
        assert!(
            (got - want).abs() < 1e-4 * want.abs().max(1.0),
            "{got} {want}"
        )
    };
    // Far, face to face, at rest.
    let mut ring = Ring::new([-1.0, 1.0], [0.0, PI]);
    let far = 0.5 * (-2.0f32).exp() + 0.4 * (-4.0f32 * 1.44).exp() + 0.1;
    ring.rewards(&params(1))
        .iter()
        .for_each(|&own| near(own, far));
    // Red approaches.
    ring.velocities[PELVIS].linear = Vec3::X * 2.0;
    let [red, blue] = ring.rewards(&params(1));
    near(red, 0.5 * (-2.0f32).exp() + 0.4 + 0.1);
    near(blue, far);
    // Near.
    let mut ring = Ring::new([-0.5, 0.5], [0.0, PI]);
    ring.rewards(&params(1))
        .iter()
        .for_each(|&own| near(own, at_rest()));
    // A punch of blue.
    ring.velocities[BODIES + LEFT_HAND].linear = Vec3::X * -0.5;
    let [red, blue] = ring.rewards(&params(1));
    near(red, at_rest());
    near(blue, at_rest() + 4.0 * 0.4);
    // It hits.
    ring.touching[PAIRS] = Vec3::X * -30.0;
    ring.touching[PAIRS + 3] = Vec3::Z * 10.0;
    let ([red, blue], measures) = ring.step(&params(1));
    near(red.reward, at_rest() - 80.0);
    near(blue.reward, at_rest() + 1.6 + 40.0);
    near(measures[MEASURES], 40.0 / 30.0);
    assert_eq!(
        (measures[0], measures[1], measures[MEASURES + 1]),
        (0.0, 0.0, 0.0)
    );
    assert_eq!((red.end, blue.end), (RUNNING, RUNNING + LEADS));
    // Accelerations at 1 m count in full.
    let mut ring = Ring::new([-0.5, 0.5], [0.0, PI]);
    ring.state[SQUARED_ACCELERATION] = 2000.0;
    let [red, blue] = ring.rewards(&params(1));
    near(red, at_rest() - 2.0);
    near(blue, at_rest());
    // Blue leans: its root's up axis is at 60 degrees.
    let mut ring = Ring::new([-0.5, 0.5], [0.0, PI]);
    ring.poses[BODIES].rotation *= Quat::from_rotation_y(PI / 3.0);
    let [red, blue] = ring.rewards(&params(1));
    near(red, at_rest() + 200.0 * 0.3);
    near(blue, at_rest());
}

#[test]
fn weights_and_switches_do_what_they_say() {
    let near = |got: f32, want: f32| {
        assert!(
            (got - want).abs() < 1e-4 * want.abs().max(1.0),
            "{got} {want}"
        )
    };
    let mut ring = Ring::new([-0.5, 0.5], [0.0, PI]);
    ring.touching[0] = Vec3::X * 100.0;
    let scaled = Params {
        damage_scale: 0.01,
        damage_taken: 0.5,
        dense: 0.25,
        ..params(1)
    };
    let [red, blue] = ring.rewards(&scaled);
    near(red, 0.25 * at_rest() + 1.0);
    near(blue, 0.25 * at_rest() - 0.5);
    let blind = Params {
        facing: 0,
        ..params(1)
    };
    let mut ring = Ring::new([-0.5, 0.5], [0.0, PI]);
    near(ring.rewards(&blind)[0], at_rest() - 10.0);
    // Without facing a fall counts from any side.
    let mut ring = Ring::new([-0.5, 0.5], [0.0, 0.0]);
    ring.poses[BODIES].rotation = Quat::from_rotation_x(FRAC_PI_2);
    near(ring.rewards(&blind)[0], at_rest() - 10.0 + 120.0);
    near(ring.rewards(&params(1))[0], at_rest() - 10.0);
}

/// Back to back, and both turned to the same side, the directions of equation 16 agree, too.
#[test]
fn only_face_to_face_counts_as_facing() {
    for (yaw, faces) in [
        ([0.0, PI], true),
        ([PI, 0.0], false),
        ([0.0, 0.0], false),
        ([PI, PI], false),
        ([1.6, 1.6 + PI], false),
    ] {
        let [red, blue] = Ring::new([-0.5, 0.5], yaw).rewards(&params(1));
        let want = if faces { at_rest() } else { at_rest() - 10.0 };
        assert!(
            (red - want).abs() < 1e-4 && (blue - want).abs() < 1e-4,
            "{yaw:?}: {red} {blue}"
        );
    }
}

#[test]
fn damage_from_behind_is_told_apart() {
    for (yaw, from_behind) in [([0.0, PI], false), ([0.0, 0.0], true), ([PI, PI], false)] {
        let mut ring = Ring::new([-0.5, 0.5], yaw);
        ring.touching[1] = Vec3::Y * 60.0;
        let (_, measures) = ring.step(&params(1));
        assert_eq!(measures[0], 2.0);
        assert_eq!(measures[1], if from_behind { 2.0 } else { 0.0 }, "{yaw:?}");
    }
}

#[test]
fn bouts_end_as_they_should() {
    let fought = |lie: [bool; 2], at: [f32; 2], params: &Params| {
        let mut ring = Ring::new(at, [0.0, PI]);
        (0..2)
            .filter(|&fighter| lie[fighter])
            .for_each(|fighter| ring.lay(fighter));
        ring.step(params)
    };
    let ([red, blue], measures) = fought([false, true], [-0.5, 0.5], &params(1));
    assert_eq!(
        (red.reward, red.end, red.group),
        (500.0, SUCCESS + LEADS, 1)
    );
    assert!(
        (blue.reward - (at_rest() - 30.0)).abs() < 2e-3,
        "{}",
        blue.reward
    );
    assert_eq!(blue.end, FAILED);
    assert_eq!((measures[2], measures[MEASURES + 2]), (1.0, 0.0));
    // Far away, too.
    let ([red, _], _) = fought([false, true], [-2.5, 2.5], &params(1));
    assert_eq!(
        (red.reward, red.end, red.group),
        (500.0, SUCCESS + LEADS, 0)
    );
    // A fall together is nobody's.
    let (steps, measures) = fought([true, true], [-0.5, 0.5], &params(1));
    assert!(
        steps
            .iter()
            .all(|step| step.end == FAILED && step.reward < 0.0)
    );
    assert_eq!((measures[2], measures[MEASURES + 2]), (0.0, 0.0));
    // Who leaves the arena has failed; the other wins, but its value goes on.
    let ([red, blue], measures) = fought([false, false], [-0.5, 3.01], &params(1));
    assert_eq!((red.end, blue.end), (TRUNCATED + LEADS, FAILED));
    assert_eq!((measures[3], measures[MEASURES + 3]), (0.0, 1.0));
    let ([red, blue], _) = fought([false, false], [2.0, 3.01], &params(1));
    assert!((red.reward - blue.reward - 30.0).abs() < 1e-3);
}

#[test]
fn a_fall_that_does_not_end_the_bout_counts_once() {
    let params = Params {
        fall_ends: 0,
        ..params(1)
    };
    let mut ring = Ring::new([-0.5, 0.5], [0.0, PI]);
    ring.lay(1);
    let (first, _) = ring.step(&params);
    let (later, _) = ring.step(&params);
    assert_eq!(first.map(|step| step.end), [RUNNING + LEADS, RUNNING]);
    assert_eq!((first[0].reward, later[0].end), (500.0, RUNNING + LEADS));
    assert!(later[0].reward < 20.0);
    assert_eq!(ring.state[KNOCKDOWNS..][..2], [1.0, 0.0]);
    // Knock-downs go before damage.
    ring.touching[PAIRS] = Vec3::X;
    let (steps, _) = ring.step(&params);
    assert_eq!(steps.map(|step| step.end), [RUNNING + LEADS, RUNNING]);
    assert_eq!(ring.state[DAMAGE], 0.0);
    assert!(ring.state[DAMAGE + 1] > 0.0);
    // Up again, and down.
    ring.poses[BODIES + HEAD].position.z = 1.4;
    ring.step(&params);
    assert_eq!(ring.state[DOWN + 1], 0.0);
    ring.lay(1);
    assert_eq!(ring.step(&params).0[0].reward, 500.0);
}

#[test]
fn only_a_fall_soon_after_a_blow_is_a_knock_down() {
    let params = Params {
        stagger_steps: 3,
        ..params(1)
    };
    for (since, knocks_down) in [(0, true), (2, true), (3, false)] {
        let mut ring = Ring::new([-0.5, 0.5], [0.0, PI]);
        ring.touching[0] = Vec3::X;
        for _ in 0..since {
            ring.step(&params);
            ring.touching[0] = Vec3::ZERO;
        }
        ring.lay(1);
        let ([red, blue], measures) = ring.step(&params);
        let end = if knocks_down { SUCCESS } else { TRUNCATED };
        assert_eq!((red.end, blue.end), (end + LEADS, FAILED), "{since}");
        assert_eq!(red.reward == 500.0, knocks_down, "{since}");
        assert_eq!(measures[2] == 1.0, knocks_down, "{since}");
    }
    // A touch is no blow.
    for (force, end) in [(9.9, TRUNCATED), (10.1, SUCCESS)] {
        let params = Params {
            blow_force: 10.0,
            ..params
        };
        let mut ring = Ring::new([-0.5, 0.5], [0.0, PI]);
        ring.touching[0] = Vec3::X * force;
        ring.lay(1);
        assert_eq!(ring.step(&params).0[0].end, end + LEADS, "{force}");
    }
    // Blue's own blows are no reason for it to fall.
    let mut ring = Ring::new([-0.5, 0.5], [0.0, PI]);
    ring.touching[PAIRS] = Vec3::X;
    ring.lay(1);
    let steps = ring.step(&params).0.map(|step| step.end);
    // It leads in damage, and has lost.
    assert_eq!(steps, [TRUNCATED + LEADS, FAILED + LEADS]);
}

#[test]
fn the_way_to_a_far_opponent_has_a_slope_everywhere() {
    let params = Params {
        additive: 1,
        far_weight: 2.0,
        dense: 0.5,
        ..params(1)
    };
    let reward = |gap: f32, yaw: f32, speed: f32| {
        let mut ring = Ring::new([-0.5 * gap, 0.5 * gap], [yaw, PI]);
        ring.velocities[PELVIS].linear = Vec3::X * speed;
        ring.rewards(&params)[0]
    };
    assert!((reward(4.0, 0.0, 1.5) - 0.6 - 0.2 - 0.04).abs() < 1e-5);
    assert!((reward(4.0, PI, 0.0) - 0.04).abs() < 1e-5);
    assert!(reward(3.0, 1.0, 0.0) > reward(4.0, 1.0, 0.0));
    assert!(reward(4.0, 2.0, 0.1) > reward(4.0, 2.1, 0.1));
    assert!(reward(4.0, 2.0, 0.0) > reward(4.0, 2.0, -0.1));
}

#[test]
fn a_clinch_is_counted_when_it_has_lasted() {
    let mut clinches = Vec::new();
    let mut ring = Ring::new([-0.2, 0.2], [0.0, PI]);
    for step in 0..8 {
        if step == 5 {
            ring = Ring {
                poses: Ring::new([-0.5, 0.5], [0.0, PI]).poses,
                ..ring
            };
        }
        let (_, measures) = ring.step(&params(1));
        clinches.push(measures[5]);
        assert_eq!(measures[4], 1.0, "engaged");
    }
    assert_eq!(clinches, [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    assert_eq!(ring.state[CLINCH_STEPS], 0.0);
}

/// Poses of two fighters, most of which stand, at any distance and turned any way. None faces straight up or down:
/// its heading would hang on a rounding.
fn poses(draw: &mut Draw, envs: usize) -> Vec<f32> {
    let mut poses = draw.normals(2 * BODIES * POSE_DIM * envs);
    for env in 0..envs {
        for body in 0..2 * BODIES {
            let at = |k: usize| (POSE_DIM * body + k) * envs + env;
            poses[at(2)] = 1.3 + 0.2 * poses[at(2)];
            let tilt = Vec2::new(poses[at(3)], poses[at(4)]).clamp_length_max(2.0) * 0.5;
            let rotation = Quat::from_rotation_z(9.0 * poses[at(5)])
                * Quat::from_scaled_axis(tilt.extend(0.0));
            (0..4).for_each(|k| poses[at(3 + k)] = rotation.to_array()[k]);
        }
    }
    poses
}

fn states(draw: &mut Draw, envs: usize) -> Vec<f32> {
    let mut state = draw.normals(state_dim(10) * envs);
    for env in 0..envs {
        for fighter in 0..2 {
            state[(KNOCKDOWNS + fighter) * envs + env] = ((env + fighter) % 3) as f32;
            state[(DOWN + fighter) * envs + env] = (env % 2) as f32;
            state[(STAGGER_STEPS + fighter) * envs + env] = (env % 3) as f32;
        }
        state[CLINCH_STEPS * envs + env] = (env % 4) as f32;
        for fighter in 0..2 {
            let squares = &mut state[(SQUARED_ACCELERATION + fighter) * envs + env];
            *squares = 1e4 * squares.abs();
        }
    }
    state
}

/// State, rewards, measures, ends and groups.
type Outputs = (Vec<f32>, Vec<f32>, Vec<f32>, Vec<u32>, Vec<u32>);

#[test]
fn boxing_rewards_agree() {
    let mut draw = Draw::new(1);
    for (case, envs) in SIZES.into_iter().cycle().take(10).enumerate() {
        let params = Params {
            fall_ends: u32::from(case % 3 > 0),
            facing: u32::from(case % 4 > 0),
            additive: u32::from(case % 2 > 0),
            stagger_steps: 2 * (case % 3) as u32,
            blow_force: 5.0,
            damage_taken: 0.5 * case as f32,
            damage_scale: 0.01,
            damage_weight: 2.0,
            dense: 0.5,
            ..params(envs)
        };
        let rows = 2 * envs;
        let poses = poses(&mut draw, envs);
        let dynamics = draw.normals((5 + 12 * BODIES) * envs);
        // No blows, and from light ones to some harder than the reward's bound.
        let mut forces = draw.normals(3 * (2 * BODIES + 2 * PAIRS) * envs);
        for (at, force) in forces.iter_mut().enumerate() {
            *force *= match at % envs % 6 {
                0 => 0.0,
                strength => 10f32.powi(strength as i32),
            };
        }
        let state = states(&mut draw, envs);
        let forms = forms!(
            boxing_reward, BOXING_REWARD, envs, params;
            poses, dynamics, forces, mut state, out 3 + rows, out MEASURES * rows, mut vec![0u32; rows],
            mut vec![7u32; 3 + rows]
        );
        let twin: &Outputs = &forms.twin;
        for (form, got) in forms.shaders() {
            close(form, &got.0, &twin.0, |_| 1e-5);
            // Terms of some hundreds may cancel each other.
            close(form, &got.1, &twin.1, |row| 2e-4 + 1e-6 * twin.1[row].abs());
            close(form, &got.2, &twin.2, |_| 1e-5);
            assert_eq!((&got.3, &got.4), (&twin.3, &twin.4), "{form}");
        }
        if envs == 1000 {
            for end in [RUNNING, SUCCESS, TRUNCATED, FAILED] {
                let found = twin.3.iter().any(|&found| found % LEADS == end);
                assert!(found || end == SUCCESS && params.fall_ends == 0, "{end}");
            }
            assert!(twin.1.contains(&500.0) && twin.4.contains(&0) && twin.4.contains(&1));
        }
    }
}

#[test]
fn boxing_observations_agree() {
    let mut draw = Draw::new(2);
    for envs in SIZES {
        let own = params(envs);
        let params = boxing_observe::Params {
            envs: envs as u32,
            at: 4,
            width: 70,
            only: 1 << RUNNING | 1 << SUCCESS,
            velocities_at: own.velocities_at,
            bodies: own.bodies,
            torso: own.torso,
            head: own.head,
            right_hand: own.right_hand,
            left_hand: own.left_hand,
            torso_up: own.torso_up,
            head_up: own.head_up,
            arena: own.arena,
        };
        let poses = poses(&mut draw, envs);
        let dynamics = draw.normals((5 + 12 * BODIES) * envs);
        let termination: Vec<u32> = (0..envs as u32).map(|env| env % 3).collect();
        let forms = forms!(
            boxing_observe, BOXING_OBSERVE, 2 * envs, params;
            poses, dynamics, termination, out 4 + 70 * 2 * envs
        );
        for (form, seen) in forms.shaders() {
            close(form, seen, &forms.twin, |_| 2e-5);
        }
    }
}

#[test]
fn joint_accelerations_agree() {
    let mut draw = Draw::new(3);
    for envs in SIZES {
        let params = joint_accelerations::Params {
            envs: envs as u32,
            positions: 6,
            dofs: 10,
            dt: 1.0 / 30.0,
        };
        let state = draw.normals(26 * envs);
        let carried = states(&mut draw, envs);
        let forms =
            forms!(joint_accelerations, JOINT_ACCELERATIONS, 2 * envs, params; state, mut carried);
        for (form, got) in forms.shaders() {
            close(form, got, &forms.twin, |at| {
                1e-5 * forms.twin[at].abs().max(1.0)
            });
        }
        let twin: &Vec<f32> = &forms.twin;
        for fighter in 0..2 {
            let speeds = (0..4).map(|joint| {
                let now = state[(6 + 10 * fighter + 6 + joint) * envs];
                let before = carried[(JOINT_SPEEDS + 4 * fighter + joint) * envs];
                assert_eq!(twin[(JOINT_SPEEDS + 4 * fighter + joint) * envs], now);
                (30.0 * (now - before)).powi(2)
            });
            let want: f32 = speeds.sum();
            assert!((twin[(SQUARED_ACCELERATION + fighter) * envs] / want - 1.0).abs() < 1e-4);
        }
    }
}

#[test]
fn fighters_agree_and_stand_on_opposite_sides() {
    let (positions, dofs) = (8, 10);
    for envs in SIZES {
        let params = place_fighters::Params {
            envs: envs as u32,
            first: 9,
            seed: 2,
            step_counter: 4,
            positions: positions as u32,
            dofs: dofs as u32,
            arena: 3.0,
            least: 1.0,
            most: 3.0,
        };
        let mut draw = Draw::new(4);
        let mut starts = draw.normals(2 * (positions + dofs) * envs);
        for (env, fighter) in (0..envs).flat_map(|env| [(env, 0), (env, 1)]) {
            let yaw = Quat::from_rotation_z(draw.within(3.0));
            let q = [yaw.w, yaw.x, yaw.y, yaw.z];
            (0..4).for_each(|k| starts[(fighter * positions + 3 + k) * envs + env] = q[k]);
        }
        let mask: Vec<u32> = (0..envs).map(|env| u32::from(env % 3 > 0)).collect();
        let forms = forms!(
            place_fighters, PLACE_FIGHTERS, envs, params;
            mask, mut starts, mut vec![7.0f32; state_dim(dofs) * envs]
        );
        for (form, (starts, state)) in forms.shaders() {
            close(form, starts, &forms.twin.0, |_| 2e-5);
            close(form, state, &forms.twin.1, |_| 1e-6);
        }
        let (placed, state): &(Vec<f32>, Vec<f32>) = &forms.twin;
        for env in 0..envs {
            let at = |field: usize| placed[field * envs + env];
            if mask[env] == 0 {
                assert_eq!((at(0), state[env]), (starts[env], 7.0));
                continue;
            }
            let spots = [0, positions].map(|q| Vec2::new(at(q), at(q + 1)));
            assert!(
                spots[0].angle_to(spots[1]).abs() > 3.0 * FRAC_PI_2 / 2.0,
                "{spots:?}"
            );
            for spot in spots {
                assert!((0.99..3.01).contains(&spot.length()), "{spot}");
                assert!(spot.abs().max_element() <= 3.0 - MARGIN);
            }
            for fighter in 0..2 {
                let speed = |from: &[f32]| {
                    let v = 2 * positions + fighter * dofs;
                    Vec2::new(from[v * envs + env], from[(v + 1) * envs + env])
                };
                let heading = |from: &[f32]| {
                    let q = |k: usize| from[(fighter * positions + 3 + k) * envs + env];
                    (Quat::from_xyzw(q(1), q(2), q(3), q(0)) * Vec3::X).truncate()
                };
                // It moves the way it did, seen from itself.
                let before = heading(&starts).angle_to(speed(&starts));
                let after = heading(placed).angle_to(speed(placed));
                let turn = Vec2::from_angle(before).angle_to(Vec2::from_angle(after));
                assert!(turn.abs() < 1e-3, "{before} {after}");
                let joint = state[(JOINT_SPEEDS + 4 * fighter) * envs + env];
                assert_eq!(joint, at(2 * positions + fighter * dofs + 6));
            }
            assert!((0..JOINT_SPEEDS).all(|field| state[field * envs + env] == 0.0));
        }
    }
}
