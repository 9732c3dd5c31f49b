//! The bodies that come with the program.

use super::mjcf;
use super::model::Model;
use std::path::Path;

/// Of the humanoid, in the model's order.
pub const BODIES: [&str; 15] = [
    "pelvis",
    "torso",
    "head",
    "right_upper_arm",
    "right_lower_arm",
    "right_hand",
    "left_upper_arm",
    "left_lower_arm",
    "left_hand",
    "right_thigh",
    "right_shin",
    "right_foot",
    "left_thigh",
    "left_shin",
    "left_foot",
];

/// The bodies whose places a policy is told: those it strikes and stands with.
pub const KEY_BODIES: [&str; 4] = ["right_hand", "left_hand", "right_foot", "left_foot"];

/// Mass of a hand, kg. The paper's larger hands would at equal density have 2.68.
pub const HAND: f32 = 0.5;

/// The humanoid of `humanoid.xml`.
pub fn humanoid() -> Model {
    included(include_str!("humanoid.xml"), "humanoid.xml")
}

/// The free box of `punching_box.xml`.
pub fn punching_box() -> Model {
    included(include_str!("punching_box.xml"), "punching_box.xml")
}

/// The humanoid with hands of another mass, kg, in the same room.
pub fn with_hands(mass: f32) -> Model {
    let mut model = humanoid();
    for body in &mut model.bodies {
        if body.name.ends_with("hand") {
            body.inertia *= mass / body.mass;
            body.mass = mass;
        }
    }
    model.loosen();
    model
}

fn included(text: &str, name: &str) -> Model {
    mjcf::parse(text, Path::new(name)).expect("what is compiled in is tested")
}
