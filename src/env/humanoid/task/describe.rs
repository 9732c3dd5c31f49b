//! What the numbers mean that a simulated body observes of itself.

use super::common::KEY_BODIES;
use crate::env::description::{TWO_AXES, VectorPart, XYZ};
use crate::physics::model::{Joint, JointKind, Model};

/// Frame of reference of observations: under the root, x where it faces on the ground, y left, z up.
pub const HEADING: &str = "heading";

/// A name in a model without the prefix of its part of the world.
pub fn own_name(name: &str) -> &str {
    name.rsplit('/').next().unwrap_or(name)
}

/// The joints of the first agent of a model in order, without its root's.
pub fn agent_joints(model: &Model) -> impl Iterator<Item = &Joint> {
    let joints = model.joints.iter();
    joints.filter(|joint| model.bodies[joint.body].tree == 0 && joint.kind != JointKind::Free)
}

/// What [`proprioception`](crate::kernels::physics::proprioception) writes of the first agent of a model.
pub fn body_parts(model: &Model) -> Vec<VectorPart> {
    let root = own_name(&model.bodies[0].name);
    let mut parts = vec![
        VectorPart::new(
            "root_height",
            &["z"],
            ["m", "world"],
            format!("height of the body `{root}` above the ground"),
        ),
        rotation_part(
            "root_rotation",
            HEADING,
            &format!("rotation of the body `{root}`"),
        ),
        VectorPart::new(
            "root_velocity",
            &XYZ,
            ["m/s", HEADING],
            format!("velocity of the body `{root}`"),
        ),
        VectorPart::new(
            "root_angular_velocity",
            &XYZ,
            ["rad/s", HEADING],
            format!("angular velocity of the body `{root}`"),
        ),
    ];
    parts.extend(agent_joints(model).map(|joint| joint_part("", joint, "")));
    parts.push(joint_velocities("joint_velocities", model, ""));
    parts.extend(KEY_BODIES.map(|key| {
        let meaning = format!(
            "position of the body `{key}` from the point on the ground below the body `{root}`"
        );
        VectorPart::new(format!("{key}_position"), &XYZ, ["m", HEADING], meaning)
    }));
    parts
}

/// Where a joint stands, with `prefix` before its name and `whose` behind what it is.
pub fn joint_part(prefix: &str, joint: &Joint, whose: &str) -> VectorPart {
    let name = own_name(&joint.name);
    let full = format!("{prefix}{name}");
    match joint.kind {
        JointKind::Hinge => {
            let meaning = format!("angle of the hinge `{name}`{whose}");
            VectorPart::new(full, &["angle"], ["rad", "joint"], meaning)
        }
        _ => {
            let meaning = format!("rotation of the ball joint `{name}`{whose}");
            rotation_part(&full, "parent body", &meaning)
        }
    }
}

/// Velocities of the joints of the first agent of a model.
pub fn joint_velocities(name: &str, model: &Model, whose: &str) -> VectorPart {
    let elements: Vec<String> = agent_joints(model).flat_map(axes).collect();
    let meaning = format!(
        "velocities of the joints{whose}: of a hinge its rate, of a ball the angular velocity of the body that it \
         moves relative to that body's parent, in that body's own frame"
    );
    VectorPart::new(name, &elements, ["rad/s", "own body"], meaning)
}

/// Names of a joint's degrees of freedom.
pub fn axes(joint: &Joint) -> Vec<String> {
    let name = own_name(&joint.name);
    match joint.kind {
        JointKind::Ball => XYZ.iter().map(|axis| format!("{name}.{axis}")).collect(),
        _ => vec![name.to_string()],
    }
}

/// A rotation as it is observed.
pub fn rotation_part(name: &str, frame: &'static str, what: &str) -> VectorPart {
    let meaning = format!("{what}: its x axis, then its z axis");
    VectorPart::new(name, &TWO_AXES, ["1", frame], meaning)
}
