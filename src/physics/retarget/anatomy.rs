//! Which joints of a skeleton are which of a person's, and which way its axes point.

use super::error::{Result, RetargetError};
use crate::motion::roles::Roles;
use crate::motion::skeleton::Skeleton;
use glam::{Mat3, Quat, Vec3};

/// Bones shorter than this are not the parts of a limb, m.
const SHORTEST: f32 = 0.02;

/// Two bones and the hinge between them.
#[derive(Clone, Copy, Debug)]
pub struct Limb {
    pub top: usize,
    pub middle: usize,
    /// Directions of the bones, in the frames of `top` and `middle`.
    pub upper: Vec3,
    pub lower: Vec3,
}

#[derive(Clone, Copy, Debug)]
pub struct Foot {
    pub ankle: usize,
    /// Direction in the ankle's frame.
    pub toe: Vec3,
}

/// The joints of a skeleton by what they are to a person; of pairs, the right one is first.
pub struct Anatomy {
    pub hips: usize,
    /// Whence both arms branch off.
    pub chest: usize,
    pub head: usize,
    /// Takes forward, left and up of a person to what they are in the frames of the trunk's joints.
    pub axes: Quat,
    pub arms: [Limb; 2],
    pub legs: [Limb; 2],
    pub feet: [Foot; 2],
}

impl Anatomy {
    pub fn of(skeleton: &Skeleton, roles: &Roles) -> Result<Anatomy> {
        let chest = chest(skeleton, roles);
        let axes = axes(skeleton, roles, chest);
        let reach = reach(skeleton);
        let leg = |hip, foot| leg(skeleton, hip, foot);
        let foot = |ankle, toe| foot(skeleton, axes, ankle, toe);
        Ok(Anatomy {
            hips: roles.hips,
            chest,
            head: head(skeleton, chest),
            axes,
            arms: [
                arm(skeleton, &reach, roles.right_shoulder)?,
                arm(skeleton, &reach, roles.left_shoulder)?,
            ],
            legs: [
                leg(roles.right_hip, roles.right_foot)?,
                leg(roles.left_hip, roles.left_foot)?,
            ],
            feet: [
                foot(roles.right_foot, roles.right_toe),
                foot(roles.left_foot, roles.left_toe),
            ],
        })
    }
}

fn above(skeleton: &Skeleton, joint: usize) -> impl Iterator<Item = usize> {
    std::iter::successors(Some(joint), |&joint| skeleton.parents[joint])
}

/// From a joint up to, and without, an ancestor; the highest first.
fn way(skeleton: &Skeleton, high: usize, low: usize) -> Vec<usize> {
    let joints = above(skeleton, low).take_while(|&joint| joint != high);
    let mut joints: Vec<usize> = joints.collect();
    joints.reverse();
    joints
}

/// The lowest joint above both shoulders.
fn chest(skeleton: &Skeleton, roles: &Roles) -> usize {
    let over = |joint: usize| above(skeleton, roles.left_shoulder).any(|high| high == joint);
    let common = above(skeleton, roles.right_shoulder).find(|&joint| over(joint));
    common.unwrap_or(roles.hips)
}

/// The joint called so, or else the one that carries it.
fn head(skeleton: &Skeleton, chest: usize) -> usize {
    let heads = |name: &String| name.to_lowercase().ends_with("head");
    let on_top = |joint: usize| above(skeleton, joint).any(|high| high == chest);
    let mut found = skeleton.names.iter().enumerate();
    let found = found.find(|&(joint, name)| heads(name) && on_top(joint));
    found.map_or(chest, |(joint, _)| joint)
}

/// The trunk's joints lie along whole axes, whichever those are: up and left as the hips see them, all
/// joints at zero.
fn axes(skeleton: &Skeleton, roles: &Roles, chest: usize) -> Quat {
    let zero = vec![Quat::IDENTITY; skeleton.joints()];
    let (at, _) = skeleton.world(Vec3::ZERO, &zero);
    let (right, left) = (at[roles.right_hip], at[roles.left_hip]);
    let shoulders = at[roles.right_shoulder] + at[roles.left_shoulder];
    // A trunk of one joint has its shoulders to tell what is above.
    let top = if chest == roles.hips {
        shoulders / 2.0
    } else {
        at[chest]
    };
    let up = nearest_axis(top - (right + left) / 2.0);
    let left = nearest_axis((left - right).reject_from(up));
    Quat::from_mat3(&Mat3::from_cols(left.cross(up), left, up))
}

fn nearest_axis(v: Vec3) -> Vec3 {
    let size = v.abs();
    let axis = [Vec3::X, Vec3::Y, Vec3::Z][size.max_position()];
    axis * v.dot(axis).signum()
}

/// How far a skeleton goes on below every joint, m.
fn reach(skeleton: &Skeleton) -> Vec<f32> {
    let mut reach = vec![0.0f32; skeleton.joints()];
    for &(joint, end) in &skeleton.ends {
        reach[joint] = reach[joint].max(end.length());
    }
    for joint in (0..skeleton.joints()).rev() {
        if let Some(parent) = skeleton.parents[joint] {
            reach[parent] = reach[parent].max(reach[joint] + skeleton.offsets[joint].length());
        }
    }
    reach
}

/// The longest bone chain below a shoulder has the elbow and then the wrist, a joint or a tip.
fn arm(skeleton: &Skeleton, reach: &[f32], shoulder: usize) -> Result<Limb> {
    let below = |joint: usize| {
        let children = (0..skeleton.joints()).filter(|&j| skeleton.parents[j] == Some(joint));
        let long = |j: usize| reach[j] + skeleton.offsets[j].length();
        children.max_by(|&a, &b| long(a).total_cmp(&long(b)))
    };
    let tip = |joint: usize| {
        let mut ends = skeleton.ends.iter();
        ends.find(|&&(at, _)| at == joint).map(|&(_, end)| end)
    };
    let limb = below(shoulder).and_then(|elbow| {
        let wrist = below(elbow).map(|wrist| skeleton.offsets[wrist]);
        limb(
            shoulder,
            elbow,
            skeleton.offsets[elbow],
            wrist.or(tip(elbow))?,
        )
    });
    limb.ok_or_else(|| unknown(skeleton, shoulder, "there is no elbow and wrist"))
}

/// The knee is the joint that halves the way from hip to ankle best.
fn leg(skeleton: &Skeleton, hip: usize, ankle: usize) -> Result<Limb> {
    let way = way(skeleton, hip, ankle);
    let length = |joints: &[usize]| {
        joints
            .iter()
            .map(|&j| skeleton.offsets[j].length())
            .sum::<f32>()
    };
    let uneven = |&count: &usize| (length(&way[..count]) - length(&way[count..])).abs();
    let halves = (1..way.len()).min_by(|a, b| uneven(a).total_cmp(&uneven(b)));
    let limb = halves.and_then(|count| {
        let [upper, lower] = [&way[..count], &way[count..]].map(|way| offset(skeleton, way));
        limb(hip, way[count - 1], upper, lower)
    });
    limb.ok_or_else(|| unknown(skeleton, hip, "there is no knee"))
}

/// Between two joints, those between them at zero.
fn offset(skeleton: &Skeleton, way: &[usize]) -> Vec3 {
    way.iter().map(|&joint| skeleton.offsets[joint]).sum()
}

fn limb(top: usize, middle: usize, upper: Vec3, lower: Vec3) -> Option<Limb> {
    let long = upper.length() > SHORTEST && lower.length() > SHORTEST;
    long.then(|| Limb {
        top,
        middle,
        upper: upper.normalize(),
        lower: lower.normalize(),
    })
}

fn unknown(skeleton: &Skeleton, joint: usize, what: &str) -> RetargetError {
    RetargetError::Skeleton {
        problem: format!("{what} below '{}'", skeleton.names[joint]),
        joints: skeleton.names.join(", "),
    }
}

/// The toe is a joint, else the foot's tip; a foot without either points where the person faces.
fn foot(skeleton: &Skeleton, axes: Quat, ankle: usize, toe: usize) -> Foot {
    let joint = offset(skeleton, &way(skeleton, ankle, toe));
    let tips = skeleton.ends.iter().filter(|&&(at, _)| at == ankle);
    let candidates = std::iter::once(joint).chain(tips.map(|&(_, tip)| tip));
    let toe = candidates.into_iter().find(|toe| toe.length() > SHORTEST);
    Foot {
        ankle,
        toe: toe.map_or(axes * Vec3::X, Vec3::normalize),
    }
}
