//! A leg: its joints, and the axis of its knee and the point of its heel as the recordings show them.

use crate::motion::database::Database;
use crate::motion::roles::Roles;
use crate::motion::skeleton::Skeleton;
use glam::{Quat, Vec3};
use serde::{Deserialize, Serialize};

/// Joints and geometry of a leg.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LegJoints {
    /// The hip joint.
    pub hip: usize,
    /// The knee joint.
    pub knee: usize,
    /// The ankle.
    pub foot: usize,
    /// The toe joint.
    pub toe: usize,
    /// The knee's axis in the hip joint's frame, unit: the shank bends about it.
    pub axis: Vec3,
    /// The point of the sole below the ankle, at the toe joint's height when the foot stands flat, in
    /// the foot joint's frame, m.
    pub heel: Vec3,
}

/// World positions (m) and rotations of every joint at one frame of the database.
pub fn world(database: &Database, frame: usize) -> (Vec<Vec3>, Vec<Quat>) {
    let joints = database.skeleton.joints();
    let rotations = &database.rotations[frame * joints..][..joints];
    database.skeleton.world(database.hips[frame], rotations)
}

/// Frames from which a leg's axis and heel are learnt: enough for a mean.
const LEARNT: usize = 4096;

/// The left leg and the right one.
pub fn legs(database: &Database) -> [LegJoints; 2] {
    let Roles {
        left_hip,
        left_foot,
        left_toe,
        right_hip,
        right_foot,
        right_toe,
        ..
    } = database.roles;
    let every = database.frames().div_ceil(LEARNT);
    let frames: Vec<_> = (0..database.frames())
        .step_by(every)
        .map(|frame| world(database, frame))
        .collect();
    [
        (left_hip, left_foot, left_toe),
        (right_hip, right_foot, right_toe),
    ]
    .map(|(hip, foot, toe)| {
        let knee = knee(&database.skeleton, hip, foot);
        LegJoints {
            hip,
            knee,
            foot,
            toe,
            axis: axis(&frames, hip, knee, foot),
            heel: heel(&frames, foot, toe),
        }
    })
}

/// The joint nearest to half-way down the leg.
fn knee(skeleton: &Skeleton, hip: usize, foot: usize) -> usize {
    let half = 0.5 * skeleton.reach(hip, foot);
    let between = std::iter::successors(skeleton.parents[foot], |&joint| skeleton.parents[joint])
        .take_while(|&joint| joint != hip);
    let from_half = |joint: &usize| (skeleton.reach(hip, *joint) - half).abs();
    between
        .min_by(|a, b| from_half(a).total_cmp(&from_half(b)))
        .unwrap_or(hip)
}

/// The mean axis about which the knee was bent, weighted by how much it was.
fn axis(frames: &[(Vec<Vec3>, Vec<Quat>)], hip: usize, knee: usize, foot: usize) -> Vec3 {
    let bends = frames.iter().map(|(at, turned)| {
        let bend = (at[knee] - at[hip]).cross(at[foot] - at[knee]);
        turned[hip].inverse() * bend
    });
    bends.sum::<Vec3>().normalize_or(Vec3::X)
}

/// Seen where the foot is as flat as it gets: the frames in which the toe is lowest and slow are
/// those in which it stands, and of those the ones with the lowest ankle stand flat.
fn heel(frames: &[(Vec<Vec3>, Vec<Quat>)], foot: usize, toe: usize) -> Vec3 {
    let mut by_height: Vec<&(Vec<Vec3>, Vec<Quat>)> = frames.iter().collect();
    by_height.sort_by(|(a, _), (b, _)| (a[foot].y + a[toe].y).total_cmp(&(b[foot].y + b[toe].y)));
    let flat = &by_height[..by_height.len().div_ceil(5)];
    let sum: Vec3 = flat
        .iter()
        .map(|(at, turned)| turned[foot].inverse() * Vec3::Y * (at[toe].y - at[foot].y))
        .sum();
    sum / flat.len() as f32
}
