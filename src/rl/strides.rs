//! A rule to move by that nobody had to learn.

use crate::kernels::self_play::scripted_actions::nearest;

/// What there is to do, of which always that is done by which a body comes nearest to a place, and faces it most.
#[derive(Clone, Debug, PartialEq)]
pub struct Strides {
    /// Index in the observation of the place: two numbers in the body's heading frame, m.
    pub target: usize,
    /// What there is to choose from; not empty.
    pub strides: Vec<Stride>,
}

/// How a body moves that does one thing.
#[derive(Clone, Debug, PartialEq)]
pub struct Stride {
    /// What it does: a latent, or an action.
    pub action: Vec<f32>,
    /// Speed along the heading, m/s.
    pub forward: f32,
    /// Speed at which the heading turns to the left, rad/s.
    pub turn: f32,
}

impl Strides {
    /// One action, whatever is observed.
    pub fn one(action: Vec<f32>) -> Strides {
        let stride = Stride {
            action,
            forward: 0.0,
            turn: 0.0,
        };
        Strides {
            target: 0,
            strides: vec![stride],
        }
    }

    /// The action of a body that observes such a row.
    pub fn choose(&self, row: &[f32]) -> &[f32] {
        let speeds = self
            .strides
            .iter()
            .map(|stride| [stride.forward, stride.turn]);
        let chosen = nearest(speeds, [row[self.target], row[self.target + 1]]);
        &self.strides[chosen].action
    }
}
