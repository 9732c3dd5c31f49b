//! Hips, spine and head, as the choreography asks.
//!
//! Everything here is seen in the frame of the heading: opponents are along z, and the hips are its
//! origin.

use super::choreography::Choreography;
use super::habits::Habits;
use crate::motion::skeleton::Skeleton;
use crate::motion::synthetic::figure::{ARM, HEAD, HIPS, JOINTS, NECK, SHOULDER, SIDE, SPINE};
use glam::{Quat, Vec3};

/// The share of the trunk's lean that the hips show.
const HIPS_LEAN: f32 = 0.4;
/// How far the head turns and leans with the shoulders, as shares, and its bow in guard (rad).
const HEAD_TURN: f32 = 0.38;
const HEAD_LEAN: f32 = 0.45;
const CHIN_DOWN: f32 = 0.12;
/// The shoulders are drawn up beside the chin (rad).
const SHRUG: f32 = 0.12;
/// A shoulder goes forward with its fist by so much (rad).
const PROTRACTION: f32 = 0.28;

/// Where the arms begin.
pub struct Trunk {
    pub neck: Vec3,
    pub shoulders: [Vec3; 2],
    pub chest: Quat,
    /// World rotations of the collar bones.
    pub collars: [Quat; 2],
    /// Rotation of the chest but for its turning.
    pub lean: Quat,
    /// Turning of the chest (rad).
    pub yaw: f32,
}

impl Trunk {
    /// Writes the rotations of hips, spine, head and collar bones into `pose`, and says where that
    /// leaves the shoulders; `stretch` is how far each fist is out, from 0 to 1.
    pub fn pose(
        plan: &Choreography,
        habits: &Habits,
        time: f32,
        stretch: [f32; 2],
        skeleton: &Skeleton,
        pose: &mut [Quat; JOINTS],
    ) -> Trunk {
        let (lean, tilt) = (plan.lean.at(time), plan.tilt.at(time));
        let leaning =
            |share: f32| Quat::from_rotation_x(share * lean) * Quat::from_rotation_z(share * tilt);
        let yaw = plan.chest.at(time) + habits.sway(time);
        let hips = leaning(HIPS_LEAN) * Quat::from_rotation_y(plan.hips.at(time));
        let chest = leaning(1.0) * Quat::from_rotation_y(yaw);
        let head = Quat::from_rotation_y(HEAD_TURN * yaw)
            * Quat::from_rotation_x(HEAD_LEAN * lean + CHIN_DOWN);

        pose[HIPS] = hips;
        let third = Quat::IDENTITY.slerp(hips.inverse() * chest, 1.0 / 3.0);
        for joint in SPINE {
            pose[joint] = third;
        }
        let half = Quat::IDENTITY.slerp(chest.inverse() * head, 0.5);
        for joint in [NECK, HEAD] {
            pose[joint] = half;
        }
        for (side, sign) in SIDE.into_iter().enumerate() {
            pose[SHOULDER[side]] = Quat::from_rotation_y(-sign * PROTRACTION * stretch[side])
                * Quat::from_rotation_z(sign * SHRUG);
        }

        let (at, rotation) = skeleton.world(Vec3::ZERO, pose);
        Trunk {
            neck: at[NECK],
            shoulders: ARM.map(|joint| at[joint]),
            collars: SHOULDER.map(|joint| rotation[joint]),
            chest,
            lean: leaning(0.7),
            yaw,
        }
    }
}
