//! What is said of the policies of simulated bodies.

use crate::env::description::VectorPart;
use crate::env::humanoid::task::EpisodeRules;
use crate::env::humanoid::task::describe::{HEADING, agent_joints, axes, own_name};
use crate::physics::model::{JointKind, Model};
use crate::physics::motion_library::MotionLibrary;
use crate::physics::simulator::{STEP_RATE, SUBSTEPS};
use crate::rl::ase::{LatentDraw, STEPS_PER_DECISION};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// How a policy moves its body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyPolicyKind {
    /// By what it observes alone.
    Acting,
    /// Under a latent that is given.
    Skilled,
    /// By a low level, whose latent it decides on.
    Steering,
}

/// Units and axes.
pub fn conventions() -> Vec<&'static str> {
    vec![
        "metres, kilograms, seconds, radians, newtons",
        "the world is right-handed with z up; the ground is the plane z = 0",
        "inputs and outputs are batches of rows, float32",
        "a number of a part is (quantity - mean) * scale; without `mean` and `scale` it is the quantity",
    ]
}

/// The frames of reference.
pub fn frames() -> BTreeMap<&'static str, &'static str> {
    [
        ("world", "as the model has it"),
        (
            HEADING,
            "the world turned about z so that x is where the root's x axis points on the ground: x forward, y left, z \
             up. A root whose x axis points straight up or down has the world's",
        ),
        (
            "parent body",
            "the frame of the body to which the joint fastens, turned as the joint has it at rest",
        ),
        ("own body", "the frame of the body that the joint moves"),
        ("joint", "about the joint's axis"),
    ]
    .into()
}

/// A body, its joints and its drives: the first agent of a model.
pub fn about_body(model: &Model) -> Value {
    let (mut drives, mut joints) = (Vec::new(), Vec::new());
    for joint in agent_joints(model) {
        let first = drives.len();
        let dofs = &model.dofs[joint.v..joint.v + joint.kind.nv()];
        for (name, dof) in axes(joint).into_iter().zip(dofs) {
            let Some(drive) = dof.drive else { continue };
            drives.push(json!({
                "name": name,
                "stiffness_nm_per_rad": drive.stiffness,
                "damping_nm_s_per_rad": drive.damping,
                "torque_limit_nm": drive.limit,
            }));
        }
        let body = &model.bodies[joint.body];
        let parent = body
            .parent
            .map(|parent| own_name(&model.bodies[parent].name));
        joints.push(json!({
            "name": own_name(&joint.name),
            "kind": if joint.kind == JointKind::Hinge { "hinge" } else { "ball" },
            "body": own_name(&body.name),
            "parent": parent,
            "axis": (joint.kind == JointKind::Hinge).then(|| joint.axis.to_array()),
            "range_rad": joint.range,
            "drives": [first, drives.len()],
        }));
    }
    json!({
        "name": "humanoid",
        "root": own_name(&model.bodies[0].name),
        "joints": joints,
        "drives": drives,
        "range": "of a hinge its least and largest angle, of a ball 0 and the largest angle to its rest",
        "physics_step_s": 1.0 / STEP_RATE,
        "physics_steps_per_step": SUBSTEPS,
        "control": "torque of a drive = stiffness * (target - position) - damping * velocity, with position and \
                    velocity as they are at the end of a physics step (implicit), at most the limit either way. The \
                    position of a ball joint's x, y and z is its rotation vector, axis times angle; `footwork export \
                    --format mjcf` writes the model",
    })
}

/// When an episode ends.
pub fn about_episode(rules: &EpisodeRules) -> Value {
    json!({
        "episode_s": rules.episode_s,
        "falls_below_m": {
            "head": rules.min_head_height,
            "pelvis": rules.min_pelvis_height,
            "any body but the feet": rules.min_body_height,
        },
    })
}

/// Targets of the drives of the first agent of a model.
pub fn target_parts(model: &Model) -> VectorPart {
    let elements: Vec<String> = agent_joints(model).flat_map(axes).collect();
    VectorPart::new(
        "targets",
        &elements,
        ["rad", "joint"],
        "of a hinge the angle, of a ball a component of the rotation vector, axis times angle, in the order of \
         `body.drives`",
    )
}

/// A latent of so many numbers.
pub fn latent_part(dim: usize) -> VectorPart {
    let elements: Vec<String> = (0..dim).map(|at| at.to_string()).collect();
    VectorPart::new("latent", &elements, ["1", "none"], "a unit vector")
}

/// Which latents there are.
pub fn about_latents(draw: &LatentDraw, recordings: Option<&MotionLibrary>) -> Value {
    let motions = recordings.map_or(&[][..], |library| library.motions());
    let clips = draw.clips().zip(motions);
    let clips: Vec<Value> = clips
        .map(|(latent, motion)| json!({ "name": motion.name, "latent": latent }))
        .collect();
    json!({
        "dim": draw.dim,
        "kept_steps": draw.kept_steps,
        "spread": draw.spread,
        "clips": clips,
        "meaning": "a latent is kept for `kept_steps`, least and most. Without clips every direction is as likely: draw \
                    normal numbers and divide them by their length. With clips each has one of its own: the clip's, or, \
                    as in training, that with normal numbers times `spread` added, divided by its length",
    })
}

/// How a policy is run.
pub fn procedure(kind: BodyPolicyKind) -> Vec<String> {
    let mut steps =
        vec!["Observe the body at the start of every step, as the input's parts say.".to_string()];
    steps.extend(match kind {
        BodyPolicyKind::Acting => None,
        BodyPolicyKind::Skilled => {
            Some("Choose a latent: see `latents`. It may change at any step.".to_string())
        }
        BodyPolicyKind::Steering => Some(format!(
            "Give `decide` = 1 at the first step of an episode and at every {STEPS_PER_DECISION}th from there, 0 at the \
             others, and as `latent` the `next_latent` of the step before. The policy decides on a latent where it is to, \
             and its low level moves the body by it at every step."
        )),
    });
    steps.push("Evaluate.".to_string());
    steps.push("Hold `targets` for the step, as `body.control` says.".to_string());
    steps
}
