//! A pointer's hold of a simulated body, which pushes it.

use super::body_playthrough::BodyPush;
use super::body_scene::ARROW;
use super::camera::{Camera, Ray};
use super::shapes::{self, seen, simulated};
use crate::physics::model::Model;
use glam::Vec3;

/// Farthest from a body's centre that a pointer takes hold of it, m.
const GRIP: f32 = 0.2;
/// The hardest push, N.
const HARDEST: f32 = 500.0;

/// The body that a pointer has hold of, and where the pointer is.
#[derive(Clone, Copy, Debug)]
pub struct BodyGrip {
    /// Number of the body.
    pub body: usize,
    /// What is seen at the pointer.
    pub ray: Ray,
}

impl BodyGrip {
    /// Takes hold of the body that is nearest to the pointer, if one is near.
    pub fn take(model: &Model, q: &[f32], ray: &Ray) -> Option<BodyGrip> {
        let distances = centres(model, q).into_iter().map(|at| ray.distance(at));
        let nearest = distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
        let near = nearest.filter(|(_, far)| *far < GRIP);
        near.map(|(body, _)| BodyGrip { body, ray: *ray })
    }

    /// The push towards the pointer: its arrow ends there.
    pub fn push(&self, model: &Model, q: &[f32], camera: &Camera) -> Option<BodyPush> {
        let centre = centres(model, q)[self.body];
        let towards = self.ray.plane(centre, camera.focus - camera.eye())?;
        let force = simulated(towards - centre) / ARROW;
        Some(BodyPush {
            body: self.body,
            force: force.clamp_length_max(HARDEST),
        })
    }
}

/// Centres of mass in the scene, m.
pub fn centres(model: &Model, q: &[f32]) -> Vec<Vec3> {
    let poses = shapes::poses(model, q);
    let bodies = model.bodies.iter().zip(&poses);
    bodies.map(|(body, pose)| seen(pose.at(body.com))).collect()
}
