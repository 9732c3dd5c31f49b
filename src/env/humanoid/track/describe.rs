//! What the numbers mean that the task adds to a body's observation.

use crate::env::description::{VectorPart, XYZ};
use crate::env::humanoid::task::describe::{
    HEADING, agent_joints, joint_part, joint_velocities, rotation_part,
};
use crate::physics::model::Model;

/// See [`track_observe`](crate::kernels::humanoid::track_observe).
pub fn parts(model: &Model) -> Vec<VectorPart> {
    let whose = " in the reference motion a step later";
    let mut parts = vec![
        VectorPart::new(
            "reference_root_position",
            &XYZ,
            ["m", HEADING],
            format!("position of the root{whose}, from the present root"),
        ),
        rotation_part(
            "reference_root_rotation",
            HEADING,
            &format!("rotation of the root{whose}"),
        ),
    ];
    parts.extend(agent_joints(model).map(|joint| joint_part("reference_", joint, whose)));
    parts.push(joint_velocities("reference_joint_velocities", model, whose));
    parts
}
