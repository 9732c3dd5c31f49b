//! The meaning of an action: targets of the drives.

use crate::physics::model::{JointKind, Model};
use std::f32::consts::PI;

/// Offsets and scales, `[2][nu]`, rad: an action's number times its scale, from its offset on, is the
/// target of a drive. Between -1 and 1 it covers, with room beyond, what the joint can do: of a ball
/// 1.2 times its range, up to half a turn, about its rest; of a hinge 1.4 times its range about the
/// middle.
pub fn action_scale(model: &Model) -> Vec<f32> {
    let driven = model.dofs.iter().filter(|dof| dof.drive.is_some());
    let (offsets, scales): (Vec<f32>, Vec<f32>) = driven
        .map(|dof| {
            let joint = &model.joints[dof.joint];
            match (joint.kind, joint.range) {
                (JointKind::Hinge, Some([low, high])) => (0.5 * (low + high), 0.7 * (high - low)),
                (_, Some([_, high])) => (0.0, (1.2 * high).min(PI)),
                (_, None) => (0.0, PI),
            }
        })
        .unzip();
    [offsets, scales].concat()
}

/// The action, `[nu]`, whose targets are those of positions `q`, `[nq]`.
pub fn rest_action(model: &Model, q: &[f32]) -> Vec<f32> {
    let targets = crate::physics::motion_clip::pd_targets(model, q);
    let scale = action_scale(model);
    let (offset, scale) = scale.split_at(targets.len());
    let pairs = targets.iter().zip(offset.iter().zip(scale));
    pairs
        .map(|(target, (offset, scale))| (target - offset) / scale)
        .collect()
}
