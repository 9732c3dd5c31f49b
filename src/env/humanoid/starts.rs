//! States in which episodes begin: random poses near standing, on the ground.

use crate::kernels::rng::{random4, uniform01};
use crate::physics::kinematics::{kinematics, store};
use crate::physics::model::{Geom, JointKind, Model};
use crate::physics::pose::Pose;
use crate::physics::spatial::Spatial;
use glam::{Quat, Vec3};
use std::f32::consts::PI;

/// States to draw from.
pub const START_STATES: usize = 1024;

/// Height of a start's feet above the ground, m: on it, rounding would decide whether they touch it.
const CLEARANCE: f32 = 1e-3;

/// How far a start may be from standing at rest, each number uniform up to these.
#[derive(Clone, Copy, Debug)]
pub struct StartSpread {
    /// Angle of a ball joint's rotation about each of its axes, and of a hinge from its initial angle
    /// into its range, rad.
    pub joint: f32,
    /// Tilt of the root about each horizontal axis, rad; its heading is any.
    pub tilt: f32,
    /// Speed of the root along each axis, m/s, and its angular speed about each, rad/s.
    pub root_speed: f32,
    /// Speed of every other degree of freedom, rad/s.
    pub joint_speed: f32,
}

const STREAM: u32 = 0x494e_4954;

/// Random states `[count][nq + nv]` of a model whose first joint is free. The lowest point of the
/// `feet` is just above the ground.
pub fn start_states(
    model: &Model,
    feet: &[usize],
    spread: &StartSpread,
    seed: u32,
    count: usize,
) -> Vec<f32> {
    let states = (0..count as u32).flat_map(|start| {
        let mut counter = 0;
        let mut draw = |most: f32| {
            counter += 1;
            let [bits, ..] = random4(seed, start, counter, STREAM);
            most * (2.0 * uniform01(bits) - 1.0)
        };
        let mut q = positions(model, spread, &mut draw);
        q[2] += CLEARANCE - lowest_point(model, feet, &q);
        let speeds = (0..model.nv()).map(|dof| match dof {
            0..6 => spread.root_speed,
            _ => spread.joint_speed,
        });
        q.extend(speeds.map(draw));
        q
    });
    states.collect()
}

fn positions(model: &Model, spread: &StartSpread, draw: &mut impl FnMut(f32) -> f32) -> Vec<f32> {
    let mut q = model.qpos0.clone();
    for joint in &model.joints {
        let q = &mut q[joint.q..];
        match joint.kind {
            JointKind::Free => {
                let heading = Quat::from_rotation_z(draw(PI));
                let tilt = Vec3::new(draw(spread.tilt), draw(spread.tilt), 0.0);
                store(&mut q[3..], heading * Quat::from_scaled_axis(tilt));
            }
            JointKind::Ball => {
                let turn = Vec3::from_array(std::array::from_fn(|_| draw(spread.joint)));
                store(q, Quat::from_scaled_axis(turn));
            }
            JointKind::Hinge => {
                let [low, high] = joint.range.unwrap_or([-PI, PI]);
                q[0] = (q[0] + draw(2.0 * spread.joint)).clamp(low, high);
            }
        }
    }
    q
}

/// Height of the lowest point of the geoms of some bodies, m.
pub fn lowest_point(model: &Model, bodies: &[usize], q: &[f32]) -> f32 {
    let mut poses = vec![Pose::default(); model.bodies.len()];
    let mut axes = vec![Spatial::ZERO; model.nv()];
    kinematics(model, q, &mut poses, &mut axes);
    let own = |geom: &&Geom| geom.body.is_some_and(|body| bodies.contains(&body));
    let heights = model
        .geoms
        .iter()
        .filter(own)
        .map(|geom| geom.lowest_point(&poses));
    heights.fold(f32::INFINITY, f32::min)
}
