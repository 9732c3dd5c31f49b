//! Inertialization: an offset that decays smoothly to zero.

use glam::Vec3;

/// An offset and its first two derivatives, per frame, at the moment it begins to decay.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InertializedOffset {
    /// The offset.
    pub value: Vec3,
    /// Its first derivative, per frame.
    pub velocity: Vec3,
    /// Its second derivative, per frame squared.
    pub acceleration: Vec3,
}

impl InertializedOffset {
    /// The offset through three values a frame apart; it begins to decay at the middle one.
    pub fn through(before: Vec3, now: Vec3, after: Vec3) -> InertializedOffset {
        InertializedOffset {
            value: now,
            velocity: 0.5 * (after - before),
            acceleration: after - 2.0 * now + before,
        }
    }

    /// The offset left after `age` frames of `frames`: the quintic that begins as given and ends at rest
    /// (Bollo, "Inertialization", GDC 2018, here for whole vectors).
    pub fn at(&self, age: f32, frames: f32) -> Vec3 {
        let s = age / frames;
        if s >= 1.0 {
            return Vec3::ZERO;
        }
        let (s2, s3, s4, s5) = (s * s, s * s * s, s * s * s * s, s * s * s * s * s);
        let value = 1.0 - 10.0 * s3 + 15.0 * s4 - 6.0 * s5;
        let velocity = frames * (s - 6.0 * s3 + 8.0 * s4 - 3.0 * s5);
        let acceleration = frames * frames * 0.5 * (s2 - 3.0 * s3 + 3.0 * s4 - s5);
        self.value * value + self.velocity * velocity + self.acceleration * acceleration
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn begins_as_given_and_ends_at_rest() {
        let offset = InertializedOffset {
            value: Vec3::new(1.0, 0.0, 0.0),
            velocity: Vec3::new(0.0, 0.1, 0.0),
            acceleration: Vec3::new(0.0, 0.0, 0.02),
        };
        // Wide steps: differences of differences leave f32 few digits.
        let (step, frames) = (0.1, 12.0);
        let velocity = |age: f32| {
            (offset.at(age + step, frames) - offset.at(age - step, frames)) / (2.0 * step)
        };
        let acceleration = |age: f32| (velocity(age + step) - velocity(age - step)) / (2.0 * step);
        assert_eq!(offset.at(0.0, frames), offset.value);
        assert!((velocity(0.0) - offset.velocity).length() < 1e-3);
        assert!(
            (acceleration(0.0) - offset.acceleration).length() < 2e-3,
            "{}",
            acceleration(0.0)
        );
        let end = frames - 2.5 * step;
        for rest in [offset.at(end, frames), velocity(end), acceleration(end)] {
            assert!(rest.length() < 2e-2, "{rest}");
        }
    }
}
