//! Who is in a world.

use super::assemble::{Part, assemble};
use super::humanoid::{humanoid, punching_box};
use super::model::Model;
use glam::Vec3;
use std::f32::consts::PI;

/// Between two boxers at the start, m.
const APART: f32 = 2.0;
/// From a puncher to its box, m.
const REACH: f32 = 1.0;

/// One humanoid.
pub fn one() -> Model {
    humanoid()
}

/// Two humanoids, "red/" and "blue/", face to face.
pub fn two() -> Model {
    let model = humanoid();
    let side = |prefix, x: f32, turn| Part {
        prefix,
        model: &model,
        place: Vec3::X * x,
        turn,
    };
    assemble(&[
        side("red/", -0.5 * APART, 0.0),
        side("blue/", 0.5 * APART, PI),
    ])
}

/// A humanoid before the box it is to punch.
pub fn punching() -> Model {
    let part = |model, x: f32| Part {
        prefix: "",
        model,
        place: Vec3::X * x,
        turn: 0.0,
    };
    assemble(&[part(&humanoid(), 0.0), part(&punching_box(), REACH)])
}

/// The box alone.
pub fn block() -> Model {
    punching_box()
}
