//! A critically damped spring: follows a number without a jerk and without overshooting.

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spring {
    pub place: f32,
    /// Per frame.
    speed: f32,
}

impl Spring {
    /// A frame later, on the way to `goal`; `rate` is the inverse of the time it takes, in frames.
    pub fn follow(&mut self, goal: f32, rate: f32) -> f32 {
        let away = self.place - goal;
        let pull = self.speed + rate * away;
        let left = (-rate).exp();
        self.place = goal + (away + pull) * left;
        self.speed = (self.speed - rate * pull) * left;
        self.place
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
            let place = spring.follow(1.0, 0.5);
            assert!(last[0] <= place && place <= 1.0);
            assert!((place - 2.0 * last[0] + last[1]).abs() < 0.15);
            last = [place, last[0]];
        }
        assert!(last[0] > 0.999);
        assert_eq!(Spring::default().follow(0.0, 0.5), 0.0);
    }
}
