//! Recorded motion as a body follows it: a row each step, cyclic motion as long as an episode.

use crate::env::humanoid::recorded::{lifted, sample_moment};
use crate::env::humanoid::task::{DT, KEY_BODIES};
use crate::kernels::humanoid::track_reward::KEYS;
use crate::physics::kinematics::{kinematics, quaternion, store};
use crate::physics::model::Model;
use crate::physics::motion_library::MotionLibrary;
use crate::physics::pose::Pose;
use crate::physics::spatial::Spatial;
use glam::{Quat, Vec3};

/// Start states drawn from a library.
const START_STATES: u32 = 4096;
/// Steps that an episode needs at least.
const LEAST: usize = 15;
/// A motion whose last pose is as near to its first goes on from there, mean of the joints' positions, rad.
const CYCLE: f32 = 0.1;

/// All that there is to follow, and where to begin.
pub struct References {
    /// `[rows][nq + nv + 3 * KEYS]`: positions, velocities, positions of the key bodies, m.
    pub rows: Vec<f32>,
    /// `[n][nq + nv]`
    pub start_states: Vec<f32>,
    /// The row of each start, and the last row of its motion, `[n][2]`.
    pub start_rows: Vec<u32>,
}

/// Rows of one motion.
struct Span {
    first: usize,
    /// Rows of the motion itself, before it is repeated.
    own: usize,
    all: usize,
}

impl References {
    /// The motions of a library, cyclic ones repeated for `steps` steps; starts are drawn by `seed`.
    pub fn new(library: &MotionLibrary, steps: usize, seed: u32) -> References {
        let model = library.model();
        let mut rows = Vec::new();
        let mut spans = Vec::new();
        let width = model.nq() + model.nv() + 3 * KEYS;
        for motion in 0..library.motions().len() {
            let frames = frames(library, motion);
            let repeated = repeated(model, &frames, steps);
            spans.push(Span {
                first: rows.len() / width,
                own: frames.len(),
                all: repeated.len(),
            });
            let row = |(q, v): &(Vec<f32>, Vec<f32>)| [q, v, &key_positions(model, q)[..]].concat();
            rows.extend(repeated.iter().flat_map(row));
        }
        let mut references = References {
            rows,
            start_states: Vec::new(),
            start_rows: Vec::new(),
        };
        for start in 0..START_STATES {
            let (motion, time) = sample_moment(library, seed, start);
            references.add_start(model, &spans[motion], time);
        }
        references
    }

    fn add_start(&mut self, model: &Model, span: &Span, time: f32) {
        let (nq, nv) = (model.nq(), model.nv());
        let row = ((time / DT) as usize).min(span.own - 1);
        // Near its end there would be nothing left to follow.
        let row = span.first + row.min(span.all.saturating_sub(LEAST));
        let state = &self.rows[row * (nq + nv + 3 * KEYS)..][..nq + nv];
        self.start_states.extend(lifted(model, &state[..nq]));
        self.start_states.extend(&state[nq..]);
        let last = span.first + span.all - 1;
        self.start_rows.extend([row as u32, last as u32]);
    }
}

/// Positions and velocities of a motion, a step a frame.
fn frames(library: &MotionLibrary, motion: usize) -> Vec<(Vec<f32>, Vec<f32>)> {
    let steps = (library.motions()[motion].seconds() / DT + 1e-3) as usize;
    let times = (0..=steps).map(|step| step as f32 * DT);
    times.map(|time| library.at(motion, time)).collect()
}

/// Frames that go on from the last as from the first until there are enough, if the motion is cyclic.
fn repeated(
    model: &Model,
    frames: &[(Vec<f32>, Vec<f32>)],
    steps: usize,
) -> Vec<(Vec<f32>, Vec<f32>)> {
    let mut all = frames.to_vec();
    let (first, last) = (&frames[0].0, &frames[frames.len() - 1].0);
    let joints = first.iter().zip(last).skip(7);
    let apart = joints.map(|(a, b)| (a - b).abs()).sum::<f32>() / (model.nq() - 7) as f32;
    if apart > CYCLE {
        return all;
    }
    while all.len() < frames.len() + steps {
        // The last frame is the first of the next round.
        let turn = Turn::between(first, &all[all.len() - 1].0);
        all.extend(frames[1..].iter().map(|(q, v)| turn.apply(q, v)));
    }
    all
}

/// A turn about the vertical, and a way over the ground.
struct Turn {
    rotation: Quat,
    from: Vec3,
    to: Vec3,
}

impl Turn {
    /// What takes the root of some positions to that of others, on the ground.
    fn between(from: &[f32], to: &[f32]) -> Turn {
        let heading = |q: &[f32]| {
            let forward = quaternion(&q[3..]) * Vec3::X;
            forward.y.atan2(forward.x)
        };
        let ground = |q: &[f32]| Vec3::new(q[0], q[1], 0.0);
        Turn {
            rotation: Quat::from_rotation_z(heading(to) - heading(from)),
            from: ground(from),
            to: ground(to),
        }
    }

    /// Positions and velocities after it. Angular velocities are the body's own: they stay.
    fn apply(&self, q: &[f32], v: &[f32]) -> (Vec<f32>, Vec<f32>) {
        let (mut q, mut v) = (q.to_vec(), v.to_vec());
        let position = self.to + self.rotation * (Vec3::from_slice(&q) - self.from);
        q[..3].copy_from_slice(&position.to_array());
        let rotation = self.rotation * quaternion(&q[3..]);
        store(&mut q[3..], rotation);
        let velocity = self.rotation * Vec3::from_slice(&v);
        v[..3].copy_from_slice(&velocity.to_array());
        (q, v)
    }
}

/// Where the key bodies are at some positions, m.
fn key_positions(model: &Model, q: &[f32]) -> [f32; 3 * KEYS] {
    let mut poses = vec![Pose::default(); model.bodies.len()];
    let mut axes = vec![Spatial::ZERO; model.nv()];
    kinematics(model, q, &mut poses, &mut axes);
    let mut out = [0.0; 3 * KEYS];
    for (out, name) in out.chunks_exact_mut(3).zip(KEY_BODIES) {
        let body = model.body(name).expect("a body of the humanoid");
        out.copy_from_slice(&poses[body].position.to_array());
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::synthetic::perform_walk;
    use crate::physics::scenes;
    use std::sync::Arc;

    #[test]
    fn references_go_on_without_a_jump() {
        let model = Arc::new(scenes::humanoid());
        let (clips, roles) = perform_walk(1, 2.0, 1.2);
        let library = MotionLibrary::of(&clips, &roles, &model).expect("the body fits");
        let frames = frames(&library, 0);
        // A second round begins where the first ended: as if the walk were cyclic.
        let turn = Turn::between(&frames[0].0, &frames[frames.len() - 1].0);
        let (q, _) = turn.apply(&frames[0].0, &frames[0].1);
        let last = &frames[frames.len() - 1].0;
        assert!((q[0] - last[0]).abs() < 1e-5 && (q[1] - last[1]).abs() < 1e-5);
        let references = References::new(&library, 300, 1);
        let rows = references.rows.len() / (model.nq() + model.nv() + 3 * KEYS);
        for start in references.start_rows.chunks_exact(2) {
            assert!(start[0] as usize + LEAST <= start[1] as usize + 1);
            assert!((start[1] as usize) < rows);
        }
    }
}
