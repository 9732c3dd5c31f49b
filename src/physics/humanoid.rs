//! The bodies that come with the program.

use super::mjcf;
use super::model::Model;
use std::path::Path;

/// Names of the humanoid's bodies, in the model's order.
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

/// The humanoid of `humanoid.xml`.
pub fn humanoid() -> Model {
    included(include_str!("humanoid.xml"), "humanoid.xml")
}

/// The free box of `punching_box.xml`.
pub fn punching_box() -> Model {
    included(include_str!("punching_box.xml"), "punching_box.xml")
}

fn included(text: &str, name: &str) -> Model {
    mjcf::parse(text, Path::new(name)).expect("what is compiled in is tested")
}
