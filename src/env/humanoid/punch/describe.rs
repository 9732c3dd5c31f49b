//! What the numbers mean that the tasks add to a body's observation.

use crate::env::description::{VectorPart, XY, XYZ};
use crate::env::humanoid::task::describe::{HEADING, rotation_part};

/// See [`punch_observe`](crate::kernels::humanoid::punch_observe).
pub fn parts(joystick: bool) -> Vec<VectorPart> {
    let mut parts = vec![
        VectorPart::new(
            "target_direction",
            &XY,
            ["1", HEADING],
            "unit vector on the ground from the root to the centre of the target, a box to be toppled",
        ),
        VectorPart::new(
            "target_distance",
            &["distance"],
            ["m", "none"],
            "distance of the two on the ground",
        )
        .scaled(0.2),
        VectorPart::new(
            "near_target",
            &XY,
            ["m", HEADING],
            "the centre of the target from the root, on the ground; if that is longer than 1.5 m, shortened to 1.5 m",
        ),
        VectorPart::new(
            "target_height",
            &["z"],
            ["m", "world"],
            "height of the centre of the target",
        ),
        VectorPart::new(
            "is_hit",
            &["hit"],
            ["1", "none"],
            "1 once the target has been hit, 0 before",
        ),
        rotation_part("target_rotation", HEADING, "rotation of the target"),
        VectorPart::new(
            "target_velocity",
            &XYZ,
            ["m/s", HEADING],
            "velocity of the target less that of the root",
        )
        .scaled(0.2),
        VectorPart::new(
            "target_angular_velocity",
            &XYZ,
            ["rad/s", HEADING],
            "angular velocity of the target",
        )
        .scaled(0.2),
    ];
    if joystick {
        let wanted = [
            ("wanted_direction", "where the body is to move"),
            ("wanted_facing", "where it is to face"),
        ];
        parts.extend(wanted.map(|(name, what)| {
            let meaning = format!("unit vector on the ground: {what}");
            VectorPart::new(name, &XY, ["1", HEADING], meaning)
        }));
    }
    parts
}
