//! Where the bodies were, frame by frame, and how far that is from another motion.

use crate::physics::kinematics::kinematics;
use crate::physics::model::Model;
use crate::physics::pose::Pose;
use crate::physics::spatial::Spatial;
use glam::{Quat, Vec3};

/// A clip whose ends are nearer than this, m, goes on with its first frame after its last.
const LOOPS: f64 = 0.15;

/// Positions of the bodies relative to the root, in its heading frame, a frame each step.
#[derive(Clone, Debug, Default)]
pub struct PoseTrack {
    frames: Vec<Vec<Vec3>>,
}

impl PoseTrack {
    /// Adds the frame of positions `q`.
    pub fn push(&mut self, model: &Model, q: &[f32]) {
        let mut poses = vec![Pose::default(); model.bodies.len()];
        let mut axes = vec![Spatial::ZERO; model.nv()];
        kinematics(model, q, &mut poses, &mut axes);
        let bodies = model.trees[0].bodies.clone();
        let root = poses[bodies.start];
        let forward = root.rotation * Vec3::X;
        let turn = Quat::from_rotation_z(-forward.y.atan2(forward.x));
        let others = poses[bodies].iter().skip(1);
        self.frames.push(
            others
                .map(|pose| turn * (pose.position - root.position))
                .collect(),
        );
    }

    /// Consecutive parts of so many frames; one of less than a third of that is left out.
    pub fn parts(&self, frames: usize) -> impl Iterator<Item = PoseTrack> {
        let parts = self.frames.chunks(frames);
        let parts = parts.filter(move |part| 3 * part.len() >= frames);
        parts.map(|frames| PoseTrack {
            frames: frames.to_vec(),
        })
    }

    /// Mean distance of the bodies, m, from the part of a reference that is nearest when aligned in time:
    /// from frame to frame the reference may stand still, or go on by one or two of its own (dynamic time
    /// warping, Sakoe and Chiba 1978).
    pub fn distance(&self, reference: &PoseTrack) -> f64 {
        let length = reference.frames.len();
        let loops = match (reference.frames.first(), reference.frames.last()) {
            (Some(first), Some(last)) => apart(first, last) < LOOPS,
            _ => return f64::INFINITY,
        };
        let mut costs = vec![0.0; length];
        for (step, frame) in self.frames.iter().enumerate() {
            let from = |index: usize, back: usize| match index.checked_sub(back) {
                Some(before) => costs[before],
                None if loops && length > back => costs[length + index - back],
                None => f64::INFINITY,
            };
            let next = (0..length).map(|index| {
                let before = match step {
                    0 => 0.0,
                    _ => (0..3)
                        .map(|back| from(index, back))
                        .fold(f64::INFINITY, f64::min),
                };
                before + apart(frame, &reference.frames[index])
            });
            costs = next.collect();
        }
        let least = costs.into_iter().fold(f64::INFINITY, f64::min);
        least / self.frames.len().max(1) as f64
    }
}

/// Mean distance of the bodies of two frames, m.
fn apart(a: &[Vec3], b: &[Vec3]) -> f64 {
    let distances = a.iter().zip(b).map(|(a, b)| f64::from(a.distance(*b)));
    distances.sum::<f64>() / a.len().max(1) as f64
}
