//! What the numbers mean that the task adds to a body's observation.

use crate::env::description::{VectorPart, XY, XYZ};
use crate::env::humanoid::task::describe::{HEADING, rotation_part};

/// See [`boxing_observe`](crate::kernels::humanoid::boxing_observe); the arena is so many metres half its width.
pub fn parts(arena: f32) -> Vec<VectorPart> {
    let mut parts = vec![
        VectorPart::new(
            "arena_centre",
            &XY,
            ["m", HEADING],
            format!("the centre of the arena on the ground from the root; its border is {arena} m from it"),
        )
        .scaled(1.0 / arena),
        VectorPart::new(
            "opponent_position",
            &XYZ,
            ["m", HEADING],
            "position of the opponent's root from the own",
        ),
        rotation_part("opponent_rotation", HEADING, "rotation of the opponent's root"),
        VectorPart::new(
            "opponent_velocity",
            &XYZ,
            ["m/s", HEADING],
            "velocity of the opponent's root less that of the own",
        ),
        VectorPart::new(
            "opponent_angular_velocity",
            &XYZ,
            ["rad/s", HEADING],
            "angular velocity of the opponent's root",
        ),
    ];
    for (who, from, to) in [
        ("own", "own", "opponent's"),
        ("opponent", "opponent's", "own"),
    ] {
        for hand in ["right_hand", "left_hand"] {
            for aim in ["torso", "head"] {
                parts.extend(reach([who, from, to], hand, aim));
            }
        }
    }
    parts
}

/// From a hand to what it is to hit.
fn reach([who, from, to]: [&str; 3], hand: &str, aim: &str) -> [VectorPart; 2] {
    let part = |quantity: &str, unit| {
        let name = format!("{who}_{hand}_to_{aim}_{quantity}");
        let meaning = format!(
            "{quantity} of the centre of the {to} body `{aim}` less that of the {from} body `{hand}`"
        );
        VectorPart::new(name, &XYZ, [unit, HEADING], meaning)
    };
    [part("position", "m"), part("velocity", "m/s")]
}
