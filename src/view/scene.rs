//! What there is to draw, in world coordinates: metres, y up.

use crate::motion::skeleton::Skeleton;
use crate::playback::CharacterPose;
use crate::playback::capsule_rig::CapsuleRig;
use crate::playback::colours::Colour;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// Two balls and the hull between them.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Capsule {
    /// Centre of one end, m.
    pub a: [f32; 3],
    /// Radius there, m.
    pub radius_a: f32,
    /// Centre of the other end, m.
    pub b: [f32; 3],
    /// Radius there, m.
    pub radius_b: f32,
    /// Colour of the surface.
    pub colour: Colour,
}

/// A box.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Cuboid {
    /// Centre, m.
    pub centre: [f32; 3],
    /// Half its sides, along its own axes, m.
    pub half: [f32; 3],
    /// Quaternion (x, y, z, w) from its own axes to the world's.
    pub rotation: [f32; 4],
    /// Colour of the surface.
    pub colour: Colour,
}

/// Everything to draw.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Capsules and balls.
    pub capsules: Vec<Capsule>,
    /// Boxes.
    pub cuboids: Vec<Cuboid>,
}

impl Cuboid {
    /// The rotation of an upright box along the world's axes.
    pub const UPRIGHT: [f32; 4] = [0.0, 0.0, 0.0, 1.0];
}

impl Scene {
    /// Adds two balls and the hull between them.
    pub fn capsule(&mut self, a: Vec3, radius_a: f32, b: Vec3, radius_b: f32, colour: Colour) {
        self.capsules.push(Capsule {
            a: a.to_array(),
            radius_a,
            b: b.to_array(),
            radius_b,
            colour,
        });
    }

    /// Adds a character.
    pub fn character(&mut self, rig: &CapsuleRig, skeleton: &Skeleton, pose: &CharacterPose) {
        let (positions, rotations) = pose.world(skeleton);
        for bone in &rig.bones {
            let [a, b] = bone.ends.map(|spot| spot.position(&positions, &rotations));
            let [from, to] = bone.ends.map(|spot| spot.radius);
            self.capsule(a, from, b, to, bone.colour);
        }
    }

    /// Adds a ball.
    pub fn ball(&mut self, centre: Vec3, radius: f32, colour: Colour) {
        self.capsule(centre, radius, centre, radius, colour);
    }

    /// A rod through points, of one thickness.
    pub fn rod(&mut self, points: &[Vec3], radius: f32, colour: Colour) {
        for pair in points.windows(2) {
            self.capsule(pair[0], radius, pair[1], radius, colour);
        }
    }

    /// A cone that ends in a point.
    pub fn tip(&mut self, base: Vec3, radius: f32, tip: Vec3, colour: Colour) {
        self.capsule(base, radius, tip, 0.002, colour);
    }

    /// An arrow: a rod that ends in a cone.
    pub fn arrow(&mut self, from: Vec3, to: Vec3, radius: f32, colour: Colour) {
        const HEAD: f32 = 6.0;
        let along = to - from;
        let neck = to - along.clamp_length_max(HEAD * radius);
        self.rod(&[from, neck], radius, colour);
        self.tip(neck, 2.5 * radius, to, colour);
    }
}
