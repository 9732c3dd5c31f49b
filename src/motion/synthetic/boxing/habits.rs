//! What differs from clip to clip, and the small movements of somebody who never quite stands still.

use crate::motion::synthetic::random::Random;
use std::f32::consts::TAU;

/// Height of the hips in guard (m).
const HEIGHT: f32 = 0.87;

/// The habits of a clip.
pub struct Habits {
    /// Height of the hips in guard (m).
    height: f32,
    /// Bobs a second, and metres up and down.
    bobs: f32,
    bob: f32,
    phases: [f32; 4],
    /// How much higher and further apart the fists are held than usual (m).
    pub raised: f32,
    pub apart: f32,
}

impl Habits {
    pub fn draw(random: &mut Random) -> Habits {
        Habits {
            height: HEIGHT + random.range(-0.012, 0.012),
            bobs: random.range(1.5, 2.0),
            bob: random.range(0.004, 0.009),
            phases: [0.0; 4].map(|_: f32| random.range(0.0, TAU)),
            raised: random.range(-0.015, 0.015),
            apart: random.range(-0.01, 0.015),
        }
    }

    /// Height of the hips before any punch lowers them (m).
    pub fn height(&self, time: f32) -> f32 {
        let fullness = 0.7 + 0.3 * self.wave(0, 0.21, time);
        self.height + self.bob * fullness * self.wave(1, self.bobs, time)
    }

    /// Shift of the weight to the left foot, as a share.
    pub fn shift(&self, time: f32) -> f32 {
        0.07 * self.wave(2, 0.43, time) + 0.04 * self.wave(3, 0.9, time)
    }

    /// Slow turning of the trunk (rad).
    pub fn sway(&self, time: f32) -> f32 {
        0.04 * self.wave(3, 0.37, time)
    }

    /// Drift of a fist in guard (m).
    pub fn drift(&self, side: usize, time: f32) -> f32 {
        0.012 * self.wave(side, 0.53, time) + 0.006 * self.wave(side + 2, 1.1, time)
    }

    fn wave(&self, phase: usize, hertz: f32, time: f32) -> f32 {
        (TAU * hertz * time + self.phases[phase]).sin()
    }
}
