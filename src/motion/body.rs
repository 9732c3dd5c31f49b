//! The body in a recording: what hangs on the hips.
//!
//! Programs put joints around the body: a root on the floor that carries it, targets of inverse
//! kinematics that move beside it, cameras, props. What carries the body goes into the motion of the
//! hips, and the rest is left out.

use super::bvh::{Recording, Slide};
use super::error::{MotionError, MotionResult};
use super::roles::{Roles, structure};
use super::skeleton::Skeleton;
use glam::Vec3;

/// A bone may change its length by this fraction of the longest bone and still count as rigid.
const SLACK: f32 = 0.05;

/// A recording whose root is the hips and whose bones are rigid.
pub struct BodyRecording {
    /// The recording without the joints that are no part of the body.
    pub recording: Recording,
    /// The roles in it.
    pub roles: Roles,
    /// Names of the joints that were left out, but for those that carry the hips.
    pub left_out: Vec<String>,
}

/// Takes the body out of a recording.
///
/// # Errors
/// A joint of the trunk, a leg or an arm that moves against its parent.
pub fn extract(recording: Recording, roles: &Roles) -> MotionResult<BodyRecording> {
    if roles.hips == 0 && recording.slides.is_empty() {
        return Ok(BodyRecording {
            recording,
            roles: *roles,
            left_out: Vec::new(),
        });
    }
    let skeleton = &recording.skeleton;
    let kept = kept(&recording, roles)?;
    let carriers = ancestors(skeleton, roles.hips);
    let is_out = |joint: &usize| !kept.contains(joint) && !carriers.contains(joint);
    let left_out = (0..skeleton.joints()).filter(is_out);
    let left_out = left_out
        .map(|joint| skeleton.names[joint].clone())
        .collect();
    let index = |joint: usize| kept.binary_search(&joint).unwrap_or_default();
    Ok(BodyRecording {
        roles: Roles::of(roles.joints().map(index)),
        left_out,
        recording: reduced(&recording, roles.hips, &kept, &carriers),
    })
}

/// The joints of the body, ascending: the hips first.
fn kept(recording: &Recording, roles: &Roles) -> MotionResult<Vec<usize>> {
    let skeleton = &recording.skeleton;
    let below = below(skeleton, roles.hips);
    let bones = below.iter().map(|&joint| skeleton.offsets[joint].length());
    let longest = bones.skip(1).fold(0.0, f32::max);
    let needed = needed(skeleton, roles);
    let mut out = vec![false; skeleton.joints()];
    for slide in &recording.slides {
        let moves = strays(slide, skeleton.offsets[slide.joint]);
        if moves <= SLACK * longest || below[1..].binary_search(&slide.joint).is_err() {
            continue;
        }
        if needed[slide.joint] {
            return Err(MotionError::Stretching {
                joint: skeleton.names[slide.joint].clone(),
                moves,
            });
        }
        out[slide.joint] = true;
    }
    for &joint in &below[1..] {
        let parent = skeleton.parents[joint].unwrap_or_default();
        out[joint] |= out[parent];
    }
    Ok(below.into_iter().filter(|&joint| !out[joint]).collect())
}

/// The farthest that a joint ever is from its mean offset.
fn strays(slide: &Slide, mean: Vec3) -> f32 {
    let strays = slide.positions.iter().map(|p| p.distance(mean));
    strays.fold(0.0, f32::max)
}

/// Whether a joint is one of those without which there is no body: those between hips and limbs, and
/// the limbs.
fn needed(skeleton: &Skeleton, roles: &Roles) -> Vec<bool> {
    let arms = [roles.left_shoulder, roles.right_shoulder];
    let arms = arms
        .into_iter()
        .filter_map(|arm| structure::limb_below(skeleton, arm));
    let mut needed = vec![false; skeleton.joints()];
    for joint in roles.joints().into_iter().chain(arms.flatten()) {
        needed[joint] = true;
        for ancestor in ancestors(skeleton, joint) {
            needed[ancestor] = true;
        }
    }
    needed
}

/// The joints that carry another, the root first.
fn ancestors(skeleton: &Skeleton, joint: usize) -> Vec<usize> {
    let up = std::iter::successors(skeleton.parents[joint], |&joint| skeleton.parents[joint]);
    let mut ancestors: Vec<usize> = up.collect();
    ancestors.reverse();
    ancestors
}

/// A joint and all that hangs on it, ascending.
fn below(skeleton: &Skeleton, top: usize) -> Vec<usize> {
    let mut inside = vec![false; skeleton.joints()];
    inside[top] = true;
    for joint in top + 1..skeleton.joints() {
        inside[joint] = skeleton.parents[joint].is_some_and(|parent| inside[parent]);
    }
    (0..inside.len()).filter(|&joint| inside[joint]).collect()
}

/// The recording of the joints `kept`, the first of which is the hips and becomes the root.
fn reduced(recording: &Recording, hips: usize, kept: &[usize], carriers: &[usize]) -> Recording {
    let skeleton = &recording.skeleton;
    let index = |joint: usize| kept.binary_search(&joint).ok();
    let chain: Vec<Carrier> = carriers[carriers.len().min(1)..]
        .iter()
        .chain((hips > 0).then_some(&hips))
        .map(|&joint| Carrier::of(recording, joint))
        .collect();
    let (mut positions, mut rotations) = (Vec::new(), Vec::new());
    for frame in 0..recording.frames() {
        let pose = recording.pose(frame);
        let (mut position, mut rotation) = (recording.positions[frame], pose[0]);
        for carrier in &chain {
            position += rotation * carrier.offset(frame);
            rotation = (rotation * pose[carrier.joint]).normalize();
        }
        positions.push(position);
        rotations.push(rotation);
        rotations.extend(kept[1..].iter().map(|&joint| pose[joint]));
    }
    let ends = skeleton.ends.iter();
    Recording {
        skeleton: Skeleton {
            names: kept.iter().map(|&j| skeleton.names[j].clone()).collect(),
            parents: kept
                .iter()
                .map(|&j| skeleton.parents[j].and_then(index))
                .collect(),
            offsets: kept.iter().map(|&j| skeleton.offsets[j]).collect(),
            ends: ends
                .filter_map(|&(j, end)| Some((index(j)?, end)))
                .collect(),
        },
        rate: recording.rate,
        positions,
        rotations,
        slides: Vec::new(),
    }
}

/// A joint between the root and the hips, or the hips.
struct Carrier<'a> {
    joint: usize,
    rest: Vec3,
    slide: Option<&'a Slide>,
}

impl<'a> Carrier<'a> {
    fn of(recording: &'a Recording, joint: usize) -> Carrier<'a> {
        Carrier {
            joint,
            rest: recording.skeleton.offsets[joint],
            slide: recording.slides.iter().find(|slide| slide.joint == joint),
        }
    }

    fn offset(&self, frame: usize) -> Vec3 {
        self.slide.map_or(self.rest, |slide| slide.positions[frame])
    }
}
