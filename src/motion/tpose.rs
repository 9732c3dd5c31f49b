//! T-poses at the head and the tail of a recording, and the way out of and into them.
//!
//! Converters put the rest pose before the motion (one frame), resampling smears it over a few
//! frames, and actors stand in it to be calibrated (seconds). None of it is motion to learn.

use super::bvh::Recording;
use super::roles::Roles;
use super::skeleton::Skeleton;

/// A frame is a T-pose if both arms reach this far sideways (1 = straight out) and both feet
/// hang this far below the hips (1 = straight legs). Walking stays below 0.5 and 1.
const ARMS_OUT: f32 = 0.85;
const LEGS_DOWN: f32 = 0.9;

/// How far the arms of a T-pose reach that nothing has smeared.
const CLEAN: f32 = 0.95;

/// The arms are down again when they reach less than this far, on average.
const ARMS_DOWN: f32 = 0.3;

/// Seconds that lowering the arms may take, and that the smear of resampling outlasts it.
const LOWERING: f32 = 1.0;
const SETTLING: f32 = 0.05;

/// How many frames to drop at the head and at the tail; (0, 0) for a recording that begins and
/// ends otherwise, that is a T-pose throughout, or whose skeleton has no arms below the shoulder.
pub fn find(recording: &Recording, roles: &Roles) -> (usize, usize) {
    let Some(limbs) = Limbs::of(&recording.skeleton, roles) else {
        return (0, 0);
    };
    let frames = recording.frames();
    let stance = |frame: usize| limbs.stance(recording, frame);
    let head = run(frames, recording.rate, stance);
    let tail = run(frames, recording.rate, |frame| stance(frames - 1 - frame));
    match head + tail < frames {
        true => (head, tail),
        false => (0, 0),
    }
}

/// How far the arms reach and whether it is a T-pose.
struct Stance {
    reach: f32,
    t_pose: bool,
}

/// Frames from the first on that belong to a T-pose.
fn run(frames: usize, rate: f32, stance: impl Fn(usize) -> Stance) -> usize {
    let still = (0..frames).take_while(|&f| stance(f).t_pose).count();
    if still == 0 {
        return 0;
    }
    let longest = still + (LOWERING * rate) as usize;
    let lowering = (still..frames.min(longest))
        .take_while(|&f| stance(f).reach > ARMS_DOWN)
        .count();
    // Only a smeared T-pose has frames between the pose and the motion, or starts out of shape.
    let smeared = lowering > 0 || stance(still - 1).reach < CLEAN;
    let settling = match smeared {
        true => (SETTLING * rate).round() as usize,
        false => 0,
    };
    (still + lowering + settling).min(frames)
}

/// The joints to look at: shoulder, elbow and hand, hip and foot, left then right.
struct Limbs {
    arms: [[usize; 3]; 2],
    legs: [[usize; 2]; 2],
}

impl Limbs {
    fn of(skeleton: &Skeleton, roles: &Roles) -> Option<Limbs> {
        let below = |joint: usize| skeleton.parents.iter().position(|&p| p == Some(joint));
        let arm = |shoulder: usize| {
            let elbow = below(shoulder)?;
            Some([shoulder, elbow, below(elbow)?])
        };
        Some(Limbs {
            arms: [arm(roles.left_shoulder)?, arm(roles.right_shoulder)?],
            legs: [
                [roles.left_hip, roles.left_foot],
                [roles.right_hip, roles.right_foot],
            ],
        })
    }

    fn stance(&self, recording: &Recording, frame: usize) -> Stance {
        let skeleton = &recording.skeleton;
        let (at, _) = skeleton.world(recording.positions[frame], recording.pose(frame));
        let left = (at[self.arms[0][0]] - at[self.arms[1][0]]).normalize_or_zero();
        let [left, right] = [(0, left), (1, -left)].map(|(arm, outwards)| {
            let [shoulder, elbow, hand] = self.arms[arm].map(|joint| at[joint]);
            let length = shoulder.distance(elbow) + elbow.distance(hand);
            (hand - shoulder).dot(outwards) / length.max(f32::MIN_POSITIVE)
        });
        let straight = self.legs.iter().all(|&[hip, foot]| {
            let length = skeleton.reach(hip, foot).max(f32::MIN_POSITIVE);
            (at[hip] - at[foot]).y / length > LEGS_DOWN
        });
        Stance {
            reach: (left + right) / 2.0,
            t_pose: left.min(right) > ARMS_OUT && straight,
        }
    }
}
