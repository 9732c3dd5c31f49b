//! A simulated body's motion as a recording's: y up, facing +z, a joint for every body.
//!
//! Joints are where their bodies' frames are, which is where the humanoid's own joints have their anchors.
//! All joints at zero, every rotation is none.

use super::kinematics::poses;
use super::model::{Body, GeomShape, Model};
use super::motion_clip::MotionClip;
use super::pose::Y_UP;
use crate::motion::clip::Clip;
use crate::motion::skeleton::Skeleton;
use glam::Vec3;

/// The motion of one of a model's trees.
pub fn skeleton_clip(model: &Model, tree: usize, motion: &MotionClip) -> Clip {
    let first = model.trees[tree].bodies.start;
    let own = &model.bodies[model.trees[tree].bodies.clone()];
    let (mut positions, mut rotations) = (Vec::new(), Vec::new());
    for frame in 0..motion.frames {
        let poses = poses(model, motion.q(frame));
        positions.push(Y_UP * poses[first].position);
        rotations.extend(own.iter().zip(&poses[first..]).map(|(body, pose)| {
            let rotation = match body.parent {
                Some(parent) => poses[parent].rotation.inverse() * pose.rotation,
                None => pose.rotation,
            };
            (Y_UP * rotation * Y_UP.inverse()).normalize()
        }));
    }
    Clip {
        name: motion.name.clone(),
        skeleton: skeleton(model, tree),
        rate: motion.rate,
        positions,
        rotations,
        source: String::new(),
        licence: String::new(),
    }
}

fn skeleton(model: &Model, tree: usize) -> Skeleton {
    let bodies = model.trees[tree].bodies.clone();
    let own = &model.bodies[bodies.clone()];
    let is_leaf = |&body: &usize| own.iter().all(|other| other.parent != Some(body));
    let parent = |body: &Body| body.parent.map(|parent| parent - bodies.start);
    Skeleton {
        names: own.iter().map(|body| body.name.clone()).collect(),
        parents: own.iter().map(parent).collect(),
        offsets: own.iter().map(|body| Y_UP * body.position).collect(),
        ends: (bodies.clone().filter(is_leaf))
            .map(|body| (body - bodies.start, Y_UP * tip(model, body)))
            .collect(),
    }
}

/// The farthest of the ends of a body's shapes, in its frame, m.
fn tip(model: &Model, body: usize) -> Vec3 {
    let bone = model.bodies[body].position.normalize_or_zero();
    let own = model.geoms.iter().filter(|geom| geom.body == Some(body));
    let ends = own.map(|geom| {
        let along = match geom.shape {
            GeomShape::Plane => Vec3::ZERO,
            GeomShape::Sphere { radius } => radius * geom.position.normalize_or(bone),
            GeomShape::Capsule { radius, half } => geom.rotation * Vec3::Z * (half + radius),
            GeomShape::Box { half } => {
                let longest = Vec3::AXES[half.max_position()];
                geom.rotation * (half * longest)
            }
        };
        // Of its two ends the one that is farther from the joint.
        match along.dot(geom.position) < 0.0 {
            true => geom.position - along,
            false => geom.position + along,
        }
    });
    ends.max_by(|a, b| a.length().total_cmp(&b.length()))
        .unwrap_or(Vec3::ZERO)
}
