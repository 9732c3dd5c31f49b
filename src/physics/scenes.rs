//! Worlds that come with the program.

use super::assemble::{Part, assemble};
pub use super::humanoid::{humanoid, punching_box};
use super::model::Model;
use glam::Vec3;
use std::f32::consts::PI;

/// Distance of two boxers at the start, m.
const BOXERS_APART: f32 = 2.0;
/// Distance of a puncher to its box at the start, m.
const BOX_APART: f32 = 1.0;

/// Two humanoids, "red/" and "blue/", face to face.
pub fn boxing_match() -> Model {
    let model = humanoid();
    let side = |prefix, x: f32, yaw| Part {
        prefix,
        model: &model,
        position: Vec3::X * x,
        yaw,
    };
    assemble(&[
        side("red/", -0.5 * BOXERS_APART, 0.0),
        side("blue/", 0.5 * BOXERS_APART, PI),
    ])
}

/// A humanoid before the box it is to punch.
pub fn humanoid_and_box() -> Model {
    let part = |model, x: f32| Part {
        prefix: "",
        model,
        position: Vec3::X * x,
        yaw: 0.0,
    };
    assemble(&[part(&humanoid(), 0.0), part(&punching_box(), BOX_APART)])
}
