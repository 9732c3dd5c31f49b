//! A skeleton drawn as capsules between its joints, thick where a person is.

use super::colours::{Colour, LEFT, RIGHT, TRUNK};
use crate::motion::roles::Roles;
use crate::motion::skeleton::Skeleton;
use bytemuck::{Pod, Zeroable};
use glam::{Quat, Vec3};

/// From the top of the thigh to the ankle of the person whose radii are given here, m.
const LEG: f32 = 0.83;

/// A ball that moves with a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Number of the joint.
    pub joint: usize,
    /// Its centre in the joint's frame, m.
    pub offset: Vec3,
    /// m
    pub radius: f32,
}

/// Two such balls and the hull between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bone {
    /// The balls.
    pub ends: [Spot; 2],
    /// Colour of the surface.
    pub colour: Colour,
}

/// A bone in a shader's table.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct BoneRow {
    ends: [u32; 2],
    /// m
    radii: [f32; 2],
    colour: [f32; 4],
}

/// All capsules of a character.
#[derive(Clone, Debug)]
pub struct CapsuleRig {
    /// The capsules.
    pub bones: Vec<Bone>,
}

/// Which part of a person a bone belongs to, by the joint at its lower end.
#[derive(Clone, Copy, PartialEq)]
enum Part {
    /// How many joints below the top of the limb.
    Leg(usize),
    Arm(usize),
    Spine,
    /// Collar bones.
    Collar,
    /// The highest bone of it is the head.
    Neck,
}

impl CapsuleRig {
    /// The rig of a skeleton, whose limbs the roles name.
    pub fn of(skeleton: &Skeleton, roles: &Roles) -> CapsuleRig {
        let scale = skeleton.reach(roles.left_hip, roles.left_foot) / LEG;
        let anatomy = Anatomy {
            skeleton,
            roles,
            scale,
        };
        CapsuleRig {
            bones: anatomy.bones(),
        }
    }

    /// The different points that bones end in: joint and offset in its frame, m.
    pub fn points(&self) -> Vec<(usize, Vec3)> {
        let mut points = Vec::new();
        for spot in self.bones.iter().flat_map(|bone| bone.ends) {
            let point = (spot.joint, spot.offset);
            if !points.contains(&point) {
                points.push(point);
            }
        }
        points
    }

    /// The bones as a shader reads them: ends by their index in [`CapsuleRig::points`].
    pub fn table(&self) -> Vec<BoneRow> {
        let points = self.points();
        let index = |spot: Spot| {
            let index = points
                .iter()
                .position(|&point| point == (spot.joint, spot.offset));
            index.unwrap_or_default() as u32
        };
        let row = |bone: &Bone| {
            let ([a, b], [r, g, bl]) = (bone.ends, bone.colour);
            BoneRow {
                ends: [index(a), index(b)],
                radii: [a.radius, b.radius],
                colour: [r, g, bl, 1.0],
            }
        };
        self.bones.iter().map(row).collect()
    }
}

impl Spot {
    /// Its centre in the world, m, where the joints have these positions and rotations.
    pub fn position(&self, positions: &[Vec3], rotations: &[Quat]) -> Vec3 {
        positions[self.joint] + rotations[self.joint] * self.offset
    }
}

struct Anatomy<'a> {
    skeleton: &'a Skeleton,
    roles: &'a Roles,
    scale: f32,
}

impl Anatomy<'_> {
    fn bones(&self) -> Vec<Bone> {
        let mut bones = self.trunk();
        let parents = self.skeleton.parents.iter().enumerate();
        for (joint, parent) in parents.filter_map(|(joint, parent)| Some((joint, (*parent)?))) {
            bones.extend(self.bone(joint, parent, Vec3::ZERO));
        }
        for &(joint, offset) in self.tips() {
            bones.extend(self.bone(joint, joint, offset));
        }
        let joints = 0..self.skeleton.joints();
        bones.extend(joints.filter_map(|joint| self.skull(joint)));
        bones
    }

    /// Tips of leaf bones; some recordings have one of no length.
    fn tips(&self) -> impl Iterator<Item = &(usize, Vec3)> {
        let ends = self.skeleton.ends.iter();
        ends.filter(|(_, offset)| offset.length() > 0.01 * self.scale)
    }

    /// The capsule that ends at `joint`, or at a leaf bone's tip `offset` from it.
    fn bone(&self, joint: usize, from: usize, offset: Vec3) -> Option<Bone> {
        let tip = usize::from(joint == from);
        let radii = match self.part(joint) {
            // The trunk fills the space between the hips and the limbs.
            Part::Leg(0) | Part::Arm(0) => return None,
            Part::Leg(depth) => match depth + tip {
                1 => [0.085, 0.058],
                2 => [0.058, 0.040],
                3 => [0.044, 0.034],
                _ => [0.034, 0.026],
            },
            Part::Arm(depth) => match depth + tip {
                1 => [0.050, 0.040],
                2 => [0.040, 0.030],
                3 => [0.034, 0.028],
                _ => [0.014, 0.010],
            },
            Part::Spine => [0.115, 0.125],
            Part::Collar => return None,
            Part::Neck if tip == 0 => [0.055, 0.050],
            Part::Neck => [0.070, 0.088],
        };
        let [a, b] = radii.map(|radius| self.scale * radius);
        Some(self.between(
            Spot {
                joint: from,
                offset: Vec3::ZERO,
                radius: a,
            },
            Spot {
                joint,
                offset,
                radius: b,
            },
        ))
    }

    /// The skull, on from the neck, where a skeleton ends at the head's joint.
    fn skull(&self, joint: usize) -> Option<Bone> {
        let way = self.skeleton.offsets[joint].normalize_or_zero();
        let head = self.part(joint) == Part::Neck && self.is_leaf(joint) && way != Vec3::ZERO;
        let spot = |above: f32, radius: f32| Spot {
            joint,
            offset: self.scale * above * way,
            radius: self.scale * radius,
        };
        head.then(|| self.between(spot(0.03, 0.080), spot(0.11, 0.092)))
    }

    /// Pelvis, flanks and shoulders, which no single bone of a skeleton is as wide as.
    fn trunk(&self) -> Vec<Bone> {
        let roles = self.roles;
        let spot = |joint, radius: f32| Spot {
            joint,
            offset: Vec3::ZERO,
            radius: self.scale * radius,
        };
        vec![
            self.between(spot(roles.left_hip, 0.095), spot(roles.right_hip, 0.095)),
            self.between(
                spot(roles.left_shoulder, 0.062),
                spot(roles.right_shoulder, 0.062),
            ),
            self.between(
                spot(roles.left_hip, 0.085),
                spot(roles.left_shoulder, 0.062),
            ),
            self.between(
                spot(roles.right_hip, 0.085),
                spot(roles.right_shoulder, 0.062),
            ),
        ]
    }

    fn between(&self, a: Spot, b: Spot) -> Bone {
        Bone {
            ends: [a, b],
            colour: self.colour(a.joint, b.joint),
        }
    }

    fn colour(&self, a: usize, b: usize) -> Colour {
        let side = |joint| {
            let limb = |tops: [usize; 2]| tops.iter().any(|&top| self.below(joint, top).is_some());
            match (
                limb([self.roles.left_hip, self.roles.left_shoulder]),
                limb([self.roles.right_hip, self.roles.right_shoulder]),
            ) {
                (true, _) => LEFT,
                (_, true) => RIGHT,
                _ => TRUNK,
            }
        };
        let flank = self.part(a) == Part::Leg(0) && self.part(b) == Part::Arm(0);
        match side(a) == side(b) && !flank {
            true => side(b),
            false => TRUNK,
        }
    }

    fn part(&self, joint: usize) -> Part {
        let depth = |tops: [usize; 2]| tops.iter().find_map(|&top| self.below(joint, top));
        let (legs, arms) = (
            [self.roles.left_hip, self.roles.right_hip],
            [self.roles.left_shoulder, self.roles.right_shoulder],
        );
        if let Some(depth) = depth(legs) {
            return Part::Leg(depth);
        }
        if let Some(depth) = depth(arms) {
            return Part::Arm(depth);
        }
        let chest = self.chest();
        if self.below(chest, joint).is_some() {
            return Part::Spine;
        }
        if arms.iter().any(|&top| self.below(top, joint).is_some()) {
            return Part::Collar;
        }
        self.below(joint, chest).map_or(Part::Spine, |_| Part::Neck)
    }

    fn is_leaf(&self, joint: usize) -> bool {
        let parents = &self.skeleton.parents;
        let end = self.tips().any(|&(at, _)| at == joint);
        !end && !parents.contains(&Some(joint))
    }

    /// The lowest joint above both shoulders.
    fn chest(&self) -> usize {
        let shoulders = [self.roles.left_shoulder, self.roles.right_shoulder];
        let above =
            std::iter::successors(Some(shoulders[0]), |&joint| self.skeleton.parents[joint]);
        let mut above = above.filter(|&joint| self.below(shoulders[1], joint).is_some());
        above.next().unwrap_or(0)
    }

    /// How many joints `low` hangs below `high`: 0 if they are the same, `None` if it does not.
    fn below(&self, low: usize, high: usize) -> Option<usize> {
        let mut above = std::iter::successors(Some(low), |&joint| self.skeleton.parents[joint]);
        above.position(|joint| joint == high)
    }
}
