//! What there is to draw, in world coordinates: metres, y up.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// Linear red, green and blue.
pub type Colour = [f32; 3];

/// Two balls and the hull between them.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Capsule {
    pub a: [f32; 3],
    pub radius_a: f32,
    pub b: [f32; 3],
    pub radius_b: f32,
    pub colour: Colour,
}

/// An upright box.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Cuboid {
    pub centre: [f32; 3],
    pub half: [f32; 3],
    pub colour: Colour,
}

#[derive(Clone, Debug, Default)]
pub struct Scene {
    pub capsules: Vec<Capsule>,
    pub cuboids: Vec<Cuboid>,
}

impl Scene {
    pub fn capsule(&mut self, a: Vec3, radius_a: f32, b: Vec3, radius_b: f32, colour: Colour) {
        self.capsules.push(Capsule {
            a: a.to_array(),
            radius_a,
            b: b.to_array(),
            radius_b,
            colour,
        });
    }

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
}
