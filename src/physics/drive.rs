//! Drives, and the springs and dampers of joints, implicit in the joint's own motion: the torque at the
//! end of a step, kp (target - q - dt v') - kd v' with v' = v + dt a, is a force that is known now and
//! one that resists acceleration like an armature of dt kd + dt^2 kp.

use super::kinematics::quaternion;
use super::model::{Drive, Joint, JointKind, JointSpring, Model};
use glam::{Quat, Vec3};

/// The force of a drive or spring, Nm, and its armature, kg m^2.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Effort {
    /// Torque at zero acceleration, Nm: kp (target - q - dt v) - kd v and what the control of a motor adds,
    /// or a drive's limit once that is passed.
    pub force: f32,
    /// Inertia that makes it implicit, kg m^2: dt kd + dt^2 kp; zero of a drive at its limit.
    pub armature: f32,
}

/// Half angles below this count as none: the axis of a rotation so small is lost in rounding.
const SMALLEST: f32 = 1e-9;

/// The exponential map's inverse: axis times angle, rad, the angle at most pi.
#[inline]
pub fn rotation_vector(rotation: Quat) -> Vec3 {
    let part = Vec3::new(rotation.x, rotation.y, rotation.z);
    let (part, w) = if rotation.w < 0.0 {
        (-part, -rotation.w)
    } else {
        (part, rotation.w)
    };
    let sine = part.length();
    match sine > SMALLEST {
        true => part * (2.0 * sine.atan2(w) / sine),
        false => part * 2.0,
    }
}

/// Where a joint's degree of freedom `axis` stands, rad.
#[inline]
fn angle(joint: &Joint, axis: usize, q: &[f32]) -> f32 {
    match joint.kind {
        JointKind::Ball => rotation_vector(quaternion(&q[joint.q..]).normalize())[axis],
        _ => q[joint.q],
    }
}

/// A pull towards a target, and against motion.
#[inline]
fn pull([stiffness, damping]: [f32; 2], target: f32, q: f32, v: f32, dt: f32) -> Effort {
    Effort {
        force: stiffness * (target - q - dt * v) - damping * v,
        armature: dt * damping + dt * dt * stiffness,
    }
}

#[inline]
fn effort(drive: &Drive, control: f32, q: f32, v: f32, dt: f32) -> Effort {
    let control = control.clamp(drive.control[0], drive.control[1]);
    let pull = pull([drive.stiffness, drive.damping], control, q, v, dt);
    Effort {
        force: drive.torque * control + pull.force,
        ..pull
    }
}

/// What the joints' own springs and dampers do, `[dofs]`.
#[inline]
pub fn spring_efforts(model: &Model, q: &[f32], v: &[f32], dt: f32, efforts: &mut [Effort]) {
    for (index, dof) in model.dofs.iter().enumerate() {
        let Some(spring) = dof.spring else { continue };
        let JointSpring {
            stiffness,
            damping,
            rest,
        } = spring;
        let joint = &model.joints[dof.joint];
        let angle = angle(joint, index - joint.v, q);
        efforts[index] = pull([stiffness, damping], rest, angle, v[index], dt);
    }
}

/// What the drives do, `[dofs]`. `targets` holds their controls, one for each driven degree of freedom in
/// order: an angle or a part of a rotation vector, rad, or a motor's part of its torque.
#[inline]
pub fn efforts(
    model: &Model,
    q: &[f32],
    v: &[f32],
    targets: &[f32],
    dt: f32,
    efforts: &mut [Effort],
) {
    let mut targets = targets.iter();
    for (index, dof) in model.dofs.iter().enumerate() {
        efforts[index] = dof.drive.map_or(Effort::default(), |drive| {
            let joint = &model.joints[dof.joint];
            let target = targets.next().copied().unwrap_or_default();
            let angle = angle(joint, index - joint.v, q);
            effort(&drive, target, angle, v[index], dt)
        });
    }
}

/// Drives whose torque would pass their limit, were they to bring about `acceleration`, push with
/// just that limit instead. Says whether there were any.
#[inline]
pub fn limit(model: &Model, acceleration: &[f32], efforts: &mut [Effort]) -> bool {
    let mut any = false;
    for (index, dof) in model.dofs.iter().enumerate() {
        let Some(drive) = dof.drive else { continue };
        let effort = &mut efforts[index];
        let torque = effort.force - effort.armature * acceleration[index];
        if torque.abs() > drive.limit {
            *effort = Effort {
                force: drive.limit.copysign(torque),
                armature: 0.0,
            };
            any = true;
        }
    }
    any
}
