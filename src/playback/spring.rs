//! A critically damped spring: follows a number without a jerk and without overshooting.

/// A number on its way to another.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spring {
    pub position: f32,
    /// Per frame.
    speed: f32,
}

impl Spring {
    /// Moves on by a frame towards `goal`; `rate` is the inverse of the time that takes, in frames.
    /// Returns the new position.
    pub fn follow(&mut self, goal: f32, rate: f32) -> f32 {
        let offset = self.position - goal;
        let pull = self.speed + rate * offset;
        let decay = (-rate).exp();
        self.position = goal + (offset + pull) * decay;
        self.speed = (self.speed - rate * pull) * decay;
        self.position
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrives_smoothly_and_never_goes_past() {
        let mut spring = Spring::default();
        let mut last = [0.0; 2];
        for _ in 0..60 {
            let position = spring.follow(1.0, 0.5);
            assert!(last[0] <= position && position <= 1.0);
            assert!((position - 2.0 * last[0] + last[1]).abs() < 0.15);
            last = [position, last[0]];
        }
        assert!(last[0] > 0.999);
        assert_eq!(Spring::default().follow(0.0, 0.5), 0.0);
    }
}
