//! Reward, measures and end of a step of the tasks `punch` and `joystick`. Shader:
//! `shaders/humanoid/punch_reward.wgsl`.

use super::approach::approach;
use super::punch_state::{FACING, FIRST, FIRST_SPEED, HAND_SPEED, HIT_STEPS, MOVING, PUNCH_STATE};
use crate::gpu::{Buffer, Gpu, groups, shader};
use crate::kernels::physics::collision::poses_of;
use crate::kernels::physics::proprioception::{heading_of, unit};
use crate::kernels::physics::smooth_dynamics::spatial;
use crate::kernels::physics::strided::{gather, scatter};
use crate::kernels::termination::{RUNNING, SUCCESS};
use crate::physics::pose::Pose;
use crate::physics::spatial::Spatial;
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

crate::shader_params! {
    pub struct Params for punch_reward {
        /// Environments of the batch.
        pub envs: u32,
        /// Index of the step's first reward.
        pub at: u32,
        /// Index of the velocities in what `smooth_dynamics` leaves.
        pub velocities_at: u32,
        /// Bodies of a world; the target is the last.
        pub bodies: u32,
        /// Bodies of the character, which come first.
        pub own_bodies: u32,
        /// Index of the right hand.
        pub right_hand: u32,
        /// Index of the left hand.
        pub left_hand: u32,
        /// 1 if facing and moving are as the state says, 0 if to the target.
        pub joystick: u32,
        /// Form of the far reward: 0 as printed, 1 with a slower distance, 2 as a sum, 3 as one for a velocity.
        pub far: u32,
        /// 1 if facing is rewarded.
        pub facing: u32,
        /// 1 if only a fist hits.
        pub fist_only: u32,
        /// Steps that the episode goes on after a hit.
        pub steps_after: u32,
        /// Wanted speed, m/s.
        pub speed: f32,
        /// Distance below which the target is near, m.
        pub near: f32,
        /// Weight of the reward for a target that is farther.
        pub far_weight: f32,
        /// Speed of a hand toward the target at which its reward is largest, m/s.
        pub hand_speed: f32,
        /// Speed below which a hand is no fist, m/s.
        pub fist_speed: f32,
    }
}

/// What is measured of a step: 1 in the step of a hit; of a hit by a fist; far from the target; the angle
/// there between facing and wanted facing, rad.
pub const MEASURES: usize = 4;
/// The target is toppled if its up axis is less than this along the world's.
const TOPPLED: f32 = 0.2;

/// Queues the shader on `gpu`.
///
/// `poses` is `[bodies * 7][envs]`, `dynamics` as `smooth_dynamics` leaves it, both of the state after the
/// step; `forces` `[(bodies + own_bodies) * 3][envs]`: on bodies, then of each body of the character on the
/// target. `task_state` is `[PUNCH_STATE][envs]`; `reward` and `group` take `[envs]` from `params.at` on, `measures`
/// `[MEASURES][envs]`, `task_end` `[envs]`.
pub fn launch(
    gpu: &Gpu,
    poses: &Buffer<f32>,
    dynamics: &Buffer<f32>,
    forces: &Buffer<f32>,
    task_state: &Buffer<f32>,
    reward: &Buffer<f32>,
    measures: &Buffer<f32>,
    task_end: &Buffer<u32>,
    group: &Buffer<u32>,
    params: &Params,
) {
    gpu.launch(
        &shader::PUNCH_REWARD,
        groups(&shader::PUNCH_REWARD, params.envs as usize),
        &[
            poses, dynamics, forces, task_state, reward, measures, task_end, group,
        ],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(
    poses: &[f32],
    dynamics: &[f32],
    forces: &[f32],
    task_state: &mut [f32],
    reward: &mut [f32],
    measures: &mut [f32],
    task_end: &mut [u32],
    group: &mut [u32],
    params: &Params,
) {
    let (envs, bodies) = (params.envs as usize, params.bodies as usize);
    let mut velocities = vec![0.0; 6 * bodies];
    let mut touching = vec![0.0; 3 * params.own_bodies as usize];
    for env in 0..envs {
        let (mut state, mut measured) = ([0.0; PUNCH_STATE], [0.0; MEASURES]);
        gather(
            dynamics,
            envs,
            env,
            params.velocities_at as usize,
            &mut velocities,
        );
        gather(forces, envs, env, 3 * bodies, &mut touching);
        gather(task_state, envs, env, 0, &mut state);
        let velocities: Vec<Spatial> = velocities.chunks_exact(6).map(spatial).collect();
        let touching: Vec<Vec3> = touching.chunks_exact(3).map(Vec3::from_slice).collect();
        let world = Bodies {
            poses: &poses_of(poses, envs, env),
            velocities: &velocities,
            touching: &touching,
        };
        let (gain, end, kind) = step(&world, &mut state, &mut measured, params);
        scatter(task_state, envs, env, 0, &state);
        scatter(measures, envs, env, 0, &measured);
        reward[params.at as usize + env] = gain;
        task_end[env] = end;
        group[params.at as usize + env] = kind;
    }
}

/// The bodies of a world after a step.
pub struct Bodies<'a> {
    /// `[bodies]`
    pub poses: &'a [Pose],
    /// About the origin of their tree, `[bodies]`.
    pub velocities: &'a [Spatial],
    /// Forces of the character's bodies on the target, `[own_bodies]`, N.
    pub touching: &'a [Vec3],
}

impl Bodies<'_> {
    /// Velocity of a body's own origin, m/s; the tree's is where its root is.
    fn velocity(&self, body: u32) -> Vec3 {
        let velocity = self.velocities[body as usize];
        let from_root = self.poses[body as usize].position - self.poses[0].position;
        velocity.linear + velocity.angular.cross(from_root)
    }
}

/// Reward of a step, how it ends for the task, and its group: the target is far, near, or has been hit.
pub fn step(
    world: &Bodies,
    state: &mut [f32],
    measures: &mut [f32],
    params: &Params,
) -> (f32, u32, u32) {
    let target = world.poses[params.bodies as usize - 1];
    let root = world.poses[0];
    let up = (target.rotation * Vec3::Z).z;
    let gap = (target.position - root.position).truncate();
    let (distance, toward) = (gap.length(), unit(gap));
    let (way, wanted) = match params.joystick {
        1 => (
            Vec2::from_slice(&state[MOVING..]),
            Vec2::from_slice(&state[FACING..]),
        ),
        _ => (toward, toward),
    };
    let alignment = heading_of(root.rotation).dot(wanted);
    note_contact(world, state, params);
    let hands = [params.right_hand, params.left_hand];
    let is_hand = |body: f32| hands.iter().any(|&hand| body == (hand + 1) as f32);
    let by_fist = is_hand(state[FIRST]) && state[FIRST_SPEED] >= params.fist_speed;
    let before = state[HIT_STEPS];
    let toppled = up < TOPPLED && (by_fist || params.fist_only == 0);
    let hit = before > 0.0 || toppled;
    if hit {
        state[HIT_STEPS] += 1.0;
    }
    let near = distance < params.near;
    let reward = if hit {
        1.4
    } else if near {
        let hands = hands.map(|hand| near_reward(world, hand, toward, target.position, params));
        0.3 + 0.3 * hands[0].max(hands[1])
    } else {
        let velocity = world.velocities[0].linear.truncate();
        params.far_weight * far_reward(distance, way, velocity, alignment, params)
    };
    let is = |fact: bool| f32::from(u8::from(fact));
    let new = toppled && before == 0.0;
    let far = is(!hit && !near);
    let angle = alignment.clamp(-1.0, 1.0).acos();
    measures.copy_from_slice(&[is(new), is(new && by_fist), far, far * angle]);
    let over = hit && before + 1.0 > params.steps_after as f32;
    let group = if hit { 2 } else { u32::from(near) };
    (reward, if over { SUCCESS } else { RUNNING }, group)
}

/// Remembers who touched the target first, and how fast the faster hand then was.
fn note_contact(world: &Bodies, state: &mut [f32], params: &Params) {
    let hands = [params.right_hand, params.left_hand];
    if state[FIRST] == 0.0 {
        let touches = |body: &u32| world.touching[*body as usize].length_squared() > 0.0;
        // A hand goes before what it drags along.
        let others = 0..params.own_bodies;
        let hand = hands.into_iter().filter(touches).max();
        let first = hand.or_else(|| others.into_iter().find(touches));
        if let Some(body) = first {
            state[FIRST] = (body + 1) as f32;
            state[FIRST_SPEED] = state[HAND_SPEED];
        }
    }
    let speeds = hands.map(|hand| world.velocity(hand).length());
    state[HAND_SPEED] = speeds[0].max(speeds[1]);
}

/// Reward for a hand that approaches the target (the paper's equations 2 to 4, whose `hand_speed` is 1 m/s).
fn near_reward(world: &Bodies, hand: u32, toward: Vec2, target: Vec3, params: &Params) -> f32 {
    let apart = target - world.poses[hand as usize].position;
    let speed = toward.dot(world.velocity(hand).truncate()) / params.hand_speed;
    0.2 * (-4.0 * apart.length_squared()).exp() + 0.8 * speed.clamp(0.0, 1.0)
}

/// Reward for going to the target (the paper's equations 5 to 10), as printed, with a distance whose slope
/// reaches further, or as a sum that has a slope everywhere: of the speed toward the target, or of the
/// difference from the wanted velocity, which counts as far as the body faces as wanted.
pub fn far_reward(
    distance: f32,
    way: Vec2,
    velocity: Vec2,
    alignment: f32,
    params: &Params,
) -> f32 {
    let along = way.dot(velocity);
    let faces = params.facing == 1;
    if params.far == 2 {
        let facing = if faces { 0.5 * (1.0 + alignment) } else { 1.0 };
        return approach(along, facing, distance);
    }
    if params.far == 3 {
        let short = (velocity - params.speed * way).length() / params.speed;
        let turned = alignment.clamp(-1.0, 1.0).acos() / PI;
        // Who does not turn to the wanted side earns little by moving.
        let facing = if faces { 1.0 - turned } else { 1.0 };
        let speed = (1.0 - short).max(-0.3);
        return 0.75 * speed * facing * facing + 0.2 * facing + 0.05 / (1.0 + distance);
    }
    let across = velocity - along * way;
    let short = params.speed - along;
    let velocity = (-4.0 * (across.length_squared() + short * short)).exp();
    let facing = if faces {
        (-5.0 * (alignment - 1.0).abs()).exp()
    } else {
        1.0
    };
    let distance = match params.far {
        1 => 1.0 / (1.0 + distance),
        _ => (-distance * distance).exp(),
    };
    distance * velocity * facing
}
