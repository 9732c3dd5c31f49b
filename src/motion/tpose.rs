//! T-poses at the head and the tail of a recording, and the way out of and into them.
//!
//! Converters put the rest pose before the motion (one frame), resampling smears it over a few
//! frames, and actors stand in it to be calibrated (seconds). None of it is motion to learn.

use super::bvh::Recording;
use super::limbs::Limbs;
use super::roles::Roles;
use super::units;
use std::ops::Range;

/// A frame is a T-pose if both arms reach this far sideways (1 = straight out), both feet
/// hang this far below the hips (1 = straight legs), and the hips stay where they are. Walking
/// stays below 0.5 and 1.
const ARMS_OUT: f32 = 0.85;
const LEGS_DOWN: f32 = 0.9;

/// The hips of who stands still move slower than this, leg lengths a second.
const STILL: f32 = 0.35;

/// How far the arms of a T-pose reach that nothing has smeared.
const CLEAN: f32 = 0.95;

/// The arms are down again when they reach less than this far, on average.
const ARMS_DOWN: f32 = 0.3;

/// Seconds that lowering the arms may take, and that the smear of resampling outlasts it.
const LOWERING: f32 = 1.0;
const SETTLING: f32 = 0.05;

/// Seconds over which resampling smears a single frame of T-pose into motion that is under way.
const SMEARED: f32 = 0.3;

/// How many frames to drop at the head and at the tail; (0, 0) for a recording that begins and
/// ends otherwise, that is a T-pose throughout, or whose skeleton has no arms below the shoulder.
pub fn find(recording: &Recording, roles: &Roles) -> (usize, usize) {
    find_within(recording, roles, 0..recording.frames())
}

/// Finds T-poses as [`find`] does, in some frames of a recording.
pub fn find_within(recording: &Recording, roles: &Roles, within: Range<usize>) -> (usize, usize) {
    let Some(limbs) = Limbs::of(&recording.skeleton, roles) else {
        return (0, 0);
    };
    let slow = STILL * units::leg(&recording.skeleton, roles) / recording.rate;
    let still = |a: usize, b: usize| recording.positions[a].distance(recording.positions[b]) < slow;
    let run = |frame: &dyn Fn(usize) -> usize| {
        run(
            within.len(),
            recording.rate,
            |at| Stance::of(&limbs, recording, frame(at)),
            |at| still(frame(at - 1), frame(at)),
        )
    };
    let head = run(&|at| within.start + at);
    let tail = run(&|at| within.end - 1 - at);
    match head + tail < within.len() {
        true => (head, tail),
        false => (0, 0),
    }
}

/// How far the arms reach and whether it is a T-pose.
struct Stance {
    reach: f32,
    t_pose: bool,
}

/// Frames from the first on that belong to a T-pose; `stays` says whether the hips are where they were
/// one frame before.
fn run(
    frames: usize,
    rate: f32,
    stance: impl Fn(usize) -> Stance,
    stays: impl Fn(usize) -> bool,
) -> usize {
    let still = (0..frames)
        .take_while(|&f| stance(f).t_pose && (f == 0 || stays(f)))
        .count();
    if still == 0 {
        return 0;
    }
    // Somebody on the move with the arms out, unless they come down at once.
    let walks = still == 1 && frames > 1 && stance(1).t_pose;
    let patience = if walks { SMEARED } else { LOWERING };
    let longest = frames.min(still + (patience * rate) as usize);
    let Some(down) = (still..longest).find(|&f| stance(f).reach <= ARMS_DOWN) else {
        // Arms that stay out are part of the motion.
        return if walks { 0 } else { still };
    };
    let lowering = down - still;
    // Only a smeared T-pose has frames between the pose and the motion, or starts out of shape.
    let smeared = lowering > 0 || stance(still - 1).reach < CLEAN;
    let settling = match smeared {
        true => (SETTLING * rate).round() as usize,
        false => 0,
    };
    (still + lowering + settling).min(frames)
}

impl Stance {
    fn of(limbs: &Limbs, recording: &Recording, frame: usize) -> Stance {
        let skeleton = &recording.skeleton;
        let (at, _) = skeleton.world(recording.positions[frame], recording.pose(frame));
        let left = (at[limbs.arms[0][0]] - at[limbs.arms[1][0]]).normalize_or_zero();
        let [left, right] = [(0, left), (1, -left)].map(|(arm, outwards)| {
            let [shoulder, elbow, hand] = limbs.arms[arm].map(|joint| at[joint]);
            let length = shoulder.distance(elbow) + elbow.distance(hand);
            (hand - shoulder).dot(outwards) / length.max(f32::MIN_POSITIVE)
        });
        let straight = limbs.legs.iter().all(|&[hip, foot]| {
            let length = skeleton.reach(hip, foot).max(f32::MIN_POSITIVE);
            (at[hip] - at[foot]).y / length > LEGS_DOWN
        });
        Stance {
            reach: (left + right) / 2.0,
            t_pose: left.min(right) > ARMS_OUT && straight,
        }
    }
}
