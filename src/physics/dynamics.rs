//! Inertias, the forces that motion itself brings, and the mass matrix (Featherstone, "Rigid Body
//! Dynamics Algorithms", tables 5.1 and 6.2), in world axes about each tree's origin.

use super::kinematics::origin;
use super::model::{JointKind, Model};
use super::pose::Pose;
use super::spatial::{Inertia, Spatial};
use glam::{Mat3, Vec3};

/// m/s^2
pub const GRAVITY: f32 = 9.81;

/// Inertia of every body, `[bodies]`.
#[inline]
pub fn inertias(model: &Model, q: &[f32], poses: &[Pose], inertias: &mut [Inertia]) {
    for (index, body) in model.bodies.iter().enumerate() {
        let rotation = Mat3::from_quat(poses[index].rotation);
        let centre = poses[index].at(body.com) - origin(model, body.tree, q);
        let about_centre = rotation * body.inertia * rotation.transpose();
        inertias[index] = Inertia::new(body.mass, centre, about_centre);
    }
}

/// Velocity of every body, `[bodies]`, and the forces `[dofs]` that would keep all degrees of freedom
/// unaccelerated against gravity and motion. `forces` is scratch, `[bodies]`.
#[inline]
pub fn bias(
    model: &Model,
    v: &[f32],
    axes: &[Spatial],
    inertias: &[Inertia],
    velocities: &mut [Spatial],
    forces: &mut [Spatial],
    bias: &mut [f32],
) {
    let weight = Spatial {
        angular: Vec3::ZERO,
        linear: Vec3::Z * GRAVITY,
    };
    // On the way out `forces` holds accelerations.
    for (index, body) in model.bodies.iter().enumerate() {
        let (mut velocity, mut acceleration) = match body.parent {
            Some(parent) => (velocities[parent], forces[parent]),
            None => (Spatial::ZERO, weight),
        };
        for joint in &model.joints[body.joints.clone()] {
            let mut dofs = joint.v..joint.v + joint.kind.nv();
            if joint.kind == JointKind::Free {
                // Its translations are along world axes, which do not turn.
                for dof in dofs.by_ref().take(3) {
                    velocity += axes[dof] * v[dof];
                }
            }
            let before = velocity;
            for dof in dofs {
                acceleration += before.cross_motion(axes[dof]) * v[dof];
                velocity += axes[dof] * v[dof];
            }
        }
        velocities[index] = velocity;
        forces[index] = acceleration;
    }
    for (index, inertia) in inertias.iter().enumerate() {
        let moving = velocities[index].cross_force(inertia.momentum(velocities[index]));
        forces[index] = inertia.momentum(forces[index]) + moving;
    }
    for (index, body) in model.bodies.iter().enumerate().rev() {
        for dof in body.dofs.clone() {
            bias[dof] = axes[dof].dot(forces[index]);
        }
        if let Some(parent) = body.parent {
            let force = forces[index];
            forces[parent] += force;
        }
    }
}

/// The mass matrix, packed as [`Dof::row`](super::model::Dof::row) says, without armature.
/// `inertias` become those of each body with all it carries.
#[inline]
pub fn mass_matrix(model: &Model, axes: &[Spatial], inertias: &mut [Inertia], matrix: &mut [f32]) {
    for (index, body) in model.bodies.iter().enumerate().rev() {
        for dof in body.dofs.clone() {
            let momentum = inertias[index].momentum(axes[dof]);
            let row = &mut matrix[model.dofs[dof].row..];
            for (entry, along) in row.iter_mut().zip(model.dof_ancestors(Some(dof))) {
                *entry = momentum.dot(axes[along]);
            }
        }
        if let Some(parent) = body.parent {
            let carried = inertias[index];
            inertias[parent] += carried;
        }
    }
}
