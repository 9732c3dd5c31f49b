//! Mirrored motion: left and right exchanged.
//!
//! The world is reflected over x = 0. A reflected rotation would turn joints inside out, so
//! each joint's own axes are reflected too, over the plane that maps the left bones on the
//! right ones: x for skeletons whose rest pose faces +z, another for those whose joints lie along
//! their bones (LaFAN1's legs run along x; its sides differ in z).

use super::clip::Clip;
use super::error::{MotionError, MotionResult};
use super::sides::{Sided, side};
use super::skeleton::Skeleton;
use glam::{Quat, Vec3};

/// How unlike left and right bones may be, relative to their summed lengths.
const LIKENESS: f32 = 0.25;

/// The mirrored copy of a clip: the left side does what the right one did and the reverse,
/// reflected over x = 0. Bone lengths are exchanged with the sides, so the reflection is exact
/// for lopsided subjects too. Mirroring twice gives the clip back.
///
/// Errors: a sided joint without its counterpart, sides that hang on the tree differently or
/// are not each other's reflection in any axis.
pub fn mirror(clip: &Clip) -> MotionResult<Clip> {
    let skeleton = &clip.skeleton;
    let pairs = pairs(skeleton)?;
    let axis = axis(skeleton, &pairs)?;
    let joints = skeleton.joints();
    let mut rotations = Vec::with_capacity(clip.rotations.len());
    for frame in 0..clip.frames() {
        let pose = clip.pose(frame);
        rotations.extend((0..joints).map(|joint| match joint {
            0 => reflect_root(pose[pairs[0]], axis),
            _ => reflect_turn(pose[pairs[joint]], axis),
        }));
    }
    Ok(Clip {
        skeleton: reflect_skeleton(skeleton, &pairs, axis),
        positions: clip.positions.iter().map(|&p| reflect(p, 0)).collect(),
        rotations,
        ..clip.clone()
    })
}

/// For each joint its counterpart on the other side; a joint of the middle is its own.
pub fn pairs(skeleton: &Skeleton) -> MotionResult<Vec<usize>> {
    let find = |name: &str| skeleton.names.iter().position(|n| n == name);
    let mut pairs = Vec::with_capacity(skeleton.joints());
    for (joint, name) in skeleton.names.iter().enumerate() {
        let Some(Sided { other, .. }) = side(name) else {
            pairs.push(joint);
            continue;
        };
        pairs.push(find(&other).ok_or_else(|| MotionError::Mirror {
            problem: format!("'{name}' has no counterpart '{other}'"),
        })?);
    }
    for (joint, parent) in skeleton.parents.iter().enumerate() {
        let other = pairs[joint];
        let same_place = skeleton.parents[other] == parent.map(|parent| pairs[parent]);
        if pairs[other] != joint || !same_place {
            return Err(MotionError::Mirror {
                problem: format!(
                    "'{}' and '{}' do not hang on the tree alike",
                    skeleton.names[joint], skeleton.names[other]
                ),
            });
        }
    }
    Ok(pairs)
}

/// The axis (0, 1, 2) whose reflection maps the offsets of each side on the other's best.
fn axis(skeleton: &Skeleton, pairs: &[usize]) -> MotionResult<usize> {
    let bones = 1..skeleton.joints();
    let total: f32 = bones.clone().map(|j| skeleton.offsets[j].length()).sum();
    let misfit = |axis: usize| -> f32 {
        let bones = bones.clone();
        let gap =
            |j: usize| reflect(skeleton.offsets[j], axis).distance(skeleton.offsets[pairs[j]]);
        bones.map(gap).sum()
    };
    // The first of equals wins, which is x.
    let best = (0..3)
        .min_by(|&a, &b| misfit(a).total_cmp(&misfit(b)))
        .unwrap_or(0);
    match misfit(best) <= LIKENESS * total {
        true => Ok(best),
        false => Err(MotionError::Mirror {
            problem: "no axis of the joints maps the left bones on the right ones".to_string(),
        }),
    }
}

fn reflect(mut v: Vec3, axis: usize) -> Vec3 {
    v[axis] = -v[axis];
    v
}

/// A local rotation seen through axes reflected on both sides: its own axis is reversed.
fn reflect_turn(rotation: Quat, axis: usize) -> Quat {
    let mut q = rotation.to_array();
    for other in (0..3).filter(|&other| other != axis) {
        q[other] = -q[other];
    }
    Quat::from_array(q)
}

/// The root's rotation takes joint axes (reflected over `axis`) to the world (over x).
fn reflect_root(rotation: Quat, axis: usize) -> Quat {
    // Two reflections over different axes are half a rotation about the third.
    let half_turn = match axis {
        0 => Quat::IDENTITY,
        1 => Quat::from_xyzw(0.0, 0.0, 1.0, 0.0),
        _ => Quat::from_xyzw(0.0, 1.0, 0.0, 0.0),
    };
    reflect_turn(rotation, 0) * half_turn
}

fn reflect_skeleton(skeleton: &Skeleton, pairs: &[usize], axis: usize) -> Skeleton {
    let offset = |joint: usize| match joint {
        // Not used by any pose, and given in the world like the root's position.
        0 => reflect(skeleton.offsets[0], 0),
        _ => reflect(skeleton.offsets[pairs[joint]], axis),
    };
    let mut ends: Vec<(usize, Vec3)> = skeleton
        .ends
        .iter()
        .map(|&(joint, end)| (pairs[joint], reflect(end, axis)))
        .collect();
    // As in files: joint by joint. The sort is stable, so the ends of one joint keep their order.
    ends.sort_by_key(|end| end.0);
    Skeleton {
        names: skeleton.names.clone(),
        parents: skeleton.parents.clone(),
        offsets: (0..skeleton.joints()).map(offset).collect(),
        ends,
    }
}
