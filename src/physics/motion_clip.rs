//! A recording of the simulated body: its positions and velocities, frame by frame.

use super::drive::rotation_vector;
use super::kinematics::{quaternion, store};
use super::model::{JointKind, Model};

/// A motion of one model, at a fixed rate.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionClip {
    /// Name of the clip that it was made from.
    pub name: String,
    /// Frames a second.
    pub rate: f32,
    /// Number of frames, 1 / `rate` seconds apart.
    pub frames: usize,
    /// `[frame][positions]`
    pub q: Vec<f32>,
    /// `[frame][dofs]`
    pub v: Vec<f32>,
}

impl MotionClip {
    /// With the velocities that its positions, `[frame][positions]`, imply.
    pub fn new(name: &str, model: &Model, rate: f32, q: Vec<f32>) -> MotionClip {
        MotionClip {
            name: name.to_string(),
            rate,
            frames: q.len() / model.nq(),
            v: velocities(model, rate, &q),
            q,
        }
    }

    /// Cuts the motion into pieces of about `seconds` s, named after it and numbered; none shares a frame with another.
    pub fn pieces(&self, model: &Model, seconds: f32) -> Vec<MotionClip> {
        let count = ((self.seconds() / seconds).round() as usize).max(1);
        let first = |piece: usize| piece * self.frames / count * model.nq();
        let piece = |piece: usize| {
            let q = self.q[first(piece)..first(piece + 1)].to_vec();
            MotionClip::new(&format!("{}.{piece}", self.name), model, self.rate, q)
        };
        (0..count).map(piece).collect()
    }

    /// From the first frame to the last.
    pub fn seconds(&self) -> f32 {
        (self.frames - 1) as f32 / self.rate
    }

    /// Positions of a frame.
    pub fn q(&self, frame: usize) -> &[f32] {
        row(&self.q, self.frames, frame)
    }

    /// Velocities of a frame.
    pub fn v(&self, frame: usize) -> &[f32] {
        row(&self.v, self.frames, frame)
    }

    /// Positions and velocities so many seconds after the first frame, and at the ends before and
    /// after them.
    pub fn at(&self, model: &Model, time: f32) -> (Vec<f32>, Vec<f32>) {
        let last = self.frames - 1;
        let index = (time * self.rate).clamp(0.0, last as f32);
        let before = index as usize;
        let after = (before + 1).min(last);
        let share = index - before as f32;
        let q = between(model, self.q(before), self.q(after), share);
        (q, mixed(self.v(before), self.v(after), share))
    }
}

/// Positions a share of the way from some to others.
pub fn between(model: &Model, from: &[f32], to: &[f32], share: f32) -> Vec<f32> {
    let mut q = mixed(from, to, share);
    for first in turns(model) {
        let [a, b] = [from, to].map(|q| quaternion(&q[first..]));
        store(&mut q[first..], a.slerp(b, share));
    }
    q
}

fn row(rows: &[f32], count: usize, row: usize) -> &[f32] {
    let width = rows.len() / count;
    &rows[row * width..][..width]
}

fn mixed(a: &[f32], b: &[f32], share: f32) -> Vec<f32> {
    let pairs = a.iter().zip(b);
    pairs.map(|(a, b)| a + share * (b - a)).collect()
}

/// Where the quaternions are in a model's positions.
fn turns(model: &Model) -> impl Iterator<Item = usize> {
    model.joints.iter().filter_map(|joint| match joint.kind {
        JointKind::Free => Some(joint.q + 3),
        JointKind::Ball => Some(joint.q),
        JointKind::Hinge => None,
    })
}

/// Targets of the drives for positions `q`, `[nu]`, as [`efforts`](super::drive::efforts) reads them.
pub fn pd_targets(model: &Model, q: &[f32]) -> Vec<f32> {
    let driven = model.dofs.iter().enumerate();
    let driven = driven.filter(|(_, dof)| dof.drive.is_some());
    driven
        .map(|(index, dof)| {
            let joint = &model.joints[dof.joint];
            match joint.kind {
                JointKind::Ball => rotation_vector(quaternion(&q[joint.q..]))[index - joint.v],
                _ => q[joint.q],
            }
        })
        .collect()
}

/// Velocities `[frame][dofs]` of positions `[frame][positions]`: differences of the frames on
/// either side, one-sided at the ends.
fn velocities(model: &Model, rate: f32, q: &[f32]) -> Vec<f32> {
    let (width, dofs) = (model.nq(), model.nv());
    let frames = q.len() / width;
    let mut v = vec![0.0; frames * dofs];
    for (frame, v) in v.chunks_exact_mut(dofs).enumerate() {
        let (before, after) = (frame.saturating_sub(1), (frame + 1).min(frames - 1));
        let rate = rate / (after - before).max(1) as f32;
        let [one, other] = [before, after].map(|frame| &q[frame * width..][..width]);
        difference(model, one, other, rate, v);
    }
    v
}

/// The velocities that lead from some positions to others in 1 / `rate` seconds.
fn difference(model: &Model, from: &[f32], to: &[f32], rate: f32, v: &mut [f32]) {
    for joint in &model.joints {
        let (from, to, v) = (&from[joint.q..], &to[joint.q..], &mut v[joint.v..]);
        let turned = |at: usize| {
            let rotation = quaternion(&from[at..]).inverse() * quaternion(&to[at..]);
            (rotation_vector(rotation) * rate).to_array()
        };
        match joint.kind {
            JointKind::Hinge => v[0] = (to[0] - from[0]) * rate,
            JointKind::Ball => v[..3].copy_from_slice(&turned(0)),
            JointKind::Free => {
                for axis in 0..3 {
                    v[axis] = (to[axis] - from[axis]) * rate;
                }
                v[3..6].copy_from_slice(&turned(3));
            }
        }
    }
}
