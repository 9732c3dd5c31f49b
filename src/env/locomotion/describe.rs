//! What the numbers of the motion-matching tasks mean.

use crate::env::description::{VectorPart, XYZ};
use crate::kernels::locomotion::locomotion_layout::TARGET_SCALE;
use crate::motion::RATE;
use crate::motion::features::{POSE_DIM, TRAJECTORY_OFFSETS};
use crate::motion::normalise::Normalisation;

/// The character frame: see [`crate::motion::character_frame`].
const FRAME: &str = "character";

/// The vector of an observation, with the database's normalisation.
pub fn observation_parts(normalisation: &Normalisation) -> Vec<VectorPart> {
    let pose = [
        ("left_foot_position", "m", "position of the left ankle"),
        ("right_foot_position", "m", "position of the right ankle"),
        ("left_foot_velocity", "m/s", "velocity of the left ankle"),
        ("right_foot_velocity", "m/s", "velocity of the right ankle"),
        ("root_velocity", "m/s", "velocity of the hips"),
    ];
    let pose = pose
        .into_iter()
        .enumerate()
        .map(|(group, (name, unit, what))| {
            let meaning =
                format!("{what} in the frame that is shown, as the database's features have it");
            let part = VectorPart::new(name, &XYZ, [unit, FRAME], meaning);
            normalised(part, normalisation, 3 * group)
        });
    let target = VectorPart::new(
        "target",
        &["x", "z"],
        ["m", FRAME],
        "position of the target on the ground, from the character",
    );
    pose.chain([target.scaled(TARGET_SCALE)]).collect()
}

/// An action, with the database's normalisation.
pub fn action_parts(normalisation: &Normalisation) -> Vec<VectorPart> {
    let parts = trajectory_parts().into_iter().enumerate();
    parts
        .map(|(number, part)| normalised(part, normalisation, POSE_DIM + 2 * number))
        .collect()
}

/// What an action asks for, in metres.
pub fn trajectory_parts() -> Vec<VectorPart> {
    let moments = TRAJECTORY_OFFSETS.into_iter().flat_map(|frames| {
        let seconds = frames as f32 / RATE;
        let part = |what: &str, unit, meaning: &str| {
            let meaning = format!("{meaning} {frames} frames ({seconds:.3} s) ahead");
            let name = format!("{what}_in_{frames}_frames");
            VectorPart::new(name, &["x", "z"], [unit, FRAME], meaning)
        };
        [
            part(
                "position",
                "m",
                "where on the ground the character is to be",
            ),
            part("heading", "1", "where it is to face, about a unit vector,"),
        ]
    });
    moments.collect()
}

fn normalised(part: VectorPart, normalisation: &Normalisation, first: usize) -> VectorPart {
    let own = first..first + part.elements.len();
    VectorPart {
        mean: normalisation.mean[own.clone()].to_vec(),
        scale: normalisation.scale[own].to_vec(),
        ..part
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::env::description::described_len;
    use crate::kernels::locomotion::locomotion_layout::BASE_OBS_DIM;
    use crate::motion::features::{FEATURE_DIM, TRAJECTORY_DIM};

    #[test]
    fn every_number_is_described() {
        let normalisation = Normalisation {
            mean: std::array::from_fn(|at| at as f32),
            scale: [2.0; FEATURE_DIM],
        };
        let observation = observation_parts(&normalisation);
        assert_eq!(described_len(&observation), BASE_OBS_DIM);
        let action = action_parts(&normalisation);
        assert_eq!(described_len(&action), TRAJECTORY_DIM);
        // One after another, as the features are.
        let parts = observation[..5].iter().chain(&action);
        let means: Vec<f32> = parts.flat_map(|part| part.mean.clone()).collect();
        assert_eq!(means, normalisation.mean);
    }
}
