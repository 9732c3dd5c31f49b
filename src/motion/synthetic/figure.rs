//! The synthetic performer's body: 22 joints in a T-pose, facing +z, left side at +x.

use crate::motion::roles::Roles;
use crate::motion::skeleton::Skeleton;
use glam::{Vec3, vec3};

/// Joint indices into [`skeleton`]; a right-hand joint follows its left one at a fixed distance.
pub const HIPS: usize = 0;
pub const UP_LEG: [usize; 2] = [1, 5];
pub const LEG: [usize; 2] = [2, 6];
pub const FOOT: [usize; 2] = [3, 7];
pub const TOE: [usize; 2] = [4, 8];
pub const SPINE: [usize; 3] = [9, 10, 11];
pub const NECK: usize = 12;
pub const HEAD: usize = 13;
pub const SHOULDER: [usize; 2] = [14, 18];
pub const ARM: [usize; 2] = [15, 19];
pub const FORE_ARM: [usize; 2] = [16, 20];
pub const HAND: [usize; 2] = [17, 21];
pub const JOINTS: usize = 22;

/// +1 for the left side, -1 for the right: the sign of x.
pub const SIDE: [f32; 2] = [1.0, -1.0];

/// Bone lengths and offsets, metres, of somebody 1.75 m tall.
pub const THIGH: f32 = 0.43;
pub const SHIN: f32 = 0.42;
pub const HIP_HALF_WIDTH: f32 = 0.09;
pub const HIP_DROP: f32 = 0.01;
/// From the ankle to the toe joint (ball of the foot), forward and down.
pub const FOOT_LENGTH: f32 = 0.13;
pub const FOOT_DROP: f32 = 0.06;
/// The heel's end of the sole lies this far behind the ankle.
pub const HEEL: f32 = 0.05;
/// Height of the toe joint, and of the sole's pivots, over the ground when the foot is flat.
pub const SOLE: f32 = 0.02;

pub fn hip(side: usize) -> Vec3 {
    vec3(SIDE[side] * HIP_HALF_WIDTH, -HIP_DROP, 0.0)
}

pub fn skeleton() -> Skeleton {
    let mut bones = vec![("Hips".to_string(), None, Vec3::ZERO)];
    for side in 0..2 {
        let start = bones.len();
        for (link, (name, offset)) in [
            ("UpLeg", hip(side)),
            ("Leg", vec3(0.0, -THIGH, 0.0)),
            ("Foot", vec3(0.0, -SHIN, 0.0)),
            ("Toe", vec3(0.0, -FOOT_DROP, FOOT_LENGTH)),
        ]
        .into_iter()
        .enumerate()
        {
            let parent = if link == 0 { HIPS } else { start + link - 1 };
            bones.push((sided(side, name), Some(parent), offset));
        }
    }
    for (name, parent, offset) in [
        ("Spine", HIPS, vec3(0.0, 0.08, -0.01)),
        ("Spine1", SPINE[0], vec3(0.0, 0.12, 0.0)),
        ("Spine2", SPINE[1], vec3(0.0, 0.13, 0.0)),
        ("Neck", SPINE[2], vec3(0.0, 0.19, 0.0)),
        ("Head", NECK, vec3(0.0, 0.1, 0.02)),
    ] {
        bones.push((name.to_string(), Some(parent), offset));
    }
    for (side, sign) in SIDE.into_iter().enumerate() {
        for (name, parent, offset) in [
            ("Shoulder", SPINE[2], vec3(sign * 0.05, 0.14, 0.0)),
            ("Arm", SHOULDER[side], vec3(sign * 0.12, 0.0, 0.0)),
            ("ForeArm", ARM[side], vec3(sign * 0.28, 0.0, 0.0)),
            ("Hand", FORE_ARM[side], vec3(sign * 0.25, 0.0, 0.0)),
        ] {
            bones.push((sided(side, name), Some(parent), offset));
        }
    }
    Skeleton {
        names: bones.iter().map(|(name, ..)| name.clone()).collect(),
        parents: bones.iter().map(|&(_, parent, _)| parent).collect(),
        offsets: bones.iter().map(|&(.., offset)| offset).collect(),
        ends: vec![
            (TOE[0], vec3(0.0, 0.0, 0.07)),
            (TOE[1], vec3(0.0, 0.0, 0.07)),
            (HEAD, vec3(0.0, 0.17, 0.0)),
            (HAND[0], vec3(0.16, 0.0, 0.0)),
            (HAND[1], vec3(-0.16, 0.0, 0.0)),
        ],
    }
}

fn sided(side: usize, name: &str) -> String {
    ["Left", "Right"][side].to_string() + name
}

pub fn roles() -> Roles {
    Roles {
        hips: HIPS,
        left_hip: UP_LEG[0],
        right_hip: UP_LEG[1],
        left_foot: FOOT[0],
        right_foot: FOOT[1],
        left_toe: TOE[0],
        right_toe: TOE[1],
        left_shoulder: ARM[0],
        right_shoulder: ARM[1],
    }
}
