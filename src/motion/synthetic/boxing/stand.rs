//! Legs under the body: the hips go where the centre of mass is in balance, heels lift as far as the
//! legs need.

use super::balance::centre_of_mass;
use super::choreography::Choreography;
use super::habits::Habits;
use crate::motion::RATE;
use crate::motion::skeleton::Skeleton;
use crate::motion::synthetic::ease::smooth;
use crate::motion::synthetic::feet::{FootState, posed};
use crate::motion::synthetic::figure::{self, HIPS, JOINTS, SHIN, THIGH};
use crate::motion::synthetic::legs;
use crate::motion::synthetic::track::heading;
use glam::{Quat, Vec3, vec3};

/// Times that the hips are moved to where the centre of mass is right.
const ROUNDS: usize = 3;
/// Frames on either side over which hips answer the swing of a limb: legs and arms are too quick for
/// the hips to balance each of their moves.
const STEADY: usize = 1;
/// A heel begins to lift when its leg is stretched to this share of its length, and by so much (rad)
/// for every further share.
const STRETCHED: f32 = 0.955;
const LIFT: f32 = 8.0;
/// Over this share it begins softly.
const SOFTLY: f32 = 0.03;
/// The most that a heel lifts (rad).
const MOST: f32 = 0.8;

/// Height of the hips (m).
pub fn height(plan: &Choreography, habits: &Habits, time: f32) -> f32 {
    habits.height(time) - plan.dip.at(time)
}

/// Positions of the hips, and poses with legs, of upper bodies whose centres of mass are to be over
/// `centres`.
pub fn stand(
    plan: &Choreography,
    habits: &Habits,
    skeleton: &Skeleton,
    mut poses: Vec<[Quat; JOINTS]>,
    centres: &[Vec3],
) -> (Vec<Vec3>, Vec<[Quat; JOINTS]>) {
    let times: Vec<f32> = (0..poses.len()).map(|frame| frame as f32 / RATE).collect();
    let offsets = poses.iter_mut().zip(centres).zip(&times);
    let offsets: Vec<Vec3> = offsets
        .map(|((pose, &centre), &time)| {
            let over = centre + Vec3::Y * height(plan, habits, time);
            balanced(plan, skeleton, pose, over, time) - centre
        })
        .collect();
    let mut pelvis = Vec::with_capacity(poses.len());
    let mut feet = Vec::with_capacity(poses.len());
    for (frame, offset) in steady(&steady(&offsets)).into_iter().enumerate() {
        let (hips, rotation) = (centres[frame] + offset, poses[frame][HIPS]);
        pelvis.push((hips, rotation));
        feet.push(both(plan, times[frame], hips, rotation));
    }
    legs::lower(&mut pelvis, &feet);
    let positions: Vec<Vec3> = pelvis.into_iter().map(|(position, _)| position).collect();
    for ((pose, &position), feet) in poses.iter_mut().zip(&positions).zip(&feet) {
        legs::join(position, feet, pose);
    }
    (positions, poses)
}

/// Position of the hips that has the centre of mass over the place where the hips begin.
fn balanced(
    plan: &Choreography,
    skeleton: &Skeleton,
    pose: &mut [Quat; JOINTS],
    over: Vec3,
    time: f32,
) -> Vec3 {
    let mut hips = over;
    for _ in 0..ROUNDS {
        legs::join(hips, &both(plan, time, hips, pose[HIPS]), pose);
        let (at, _) = skeleton.world(hips, &pose[..]);
        hips += (over - centre_of_mass(&at)) * vec3(1.0, 0.0, 1.0);
    }
    hips
}

/// Means over the frames around each.
fn steady(offsets: &[Vec3]) -> Vec<Vec3> {
    let last = offsets.len() - 1;
    (0..=last)
        .map(|frame| {
            let near = &offsets[frame.saturating_sub(STEADY)..=(frame + STEADY).min(last)];
            near.iter().sum::<Vec3>() / near.len() as f32
        })
        .collect()
}

fn both(plan: &Choreography, time: f32, hips: Vec3, rotation: Quat) -> [FootState; 2] {
    [0, 1].map(|side| foot(plan, side, time, hips + rotation * figure::hip(side)))
}

/// A foot at a moment, below a hip joint.
fn foot(plan: &Choreography, side: usize, time: f32, hip: Vec3) -> FootState {
    let footing = &plan.feet[side];
    let (ball, yaw) = (footing.ball(time), footing.yaw.at(time));
    let (rise, air) = footing.lift(time);
    let lifted = |heel: f32| posed(ball, yaw, -heel, rise, air);
    let flat = lifted(footing.heel.at(time)).ankle;
    let need = need(hip - flat, yaw);
    FootState {
        planted: footing.is_planted(time),
        ..lifted((footing.heel.at(time) + need).min(MOST))
    }
}

/// How much further the heel of a foot that stays behind lifts so that its leg need not stretch
/// (rad): `leg` leads from the ankle to the hip.
fn need(leg: Vec3, yaw: f32) -> f32 {
    let stretched = leg.length() / (THIGH + SHIN) - STRETCHED;
    let soft = 0.5 * (stretched + stretched.hypot(SOFTLY));
    LIFT * soft * smooth(-0.05, 0.15, leg.dot(heading(yaw)))
}
