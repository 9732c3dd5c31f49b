//! Where the scene is seen from.

use glam::camera::rh::proj::directx::perspective;
use glam::camera::rh::view::look_at_mat4;
use glam::{Mat4, Vec2, Vec3};

/// Height of the picture as an angle, rad.
const FIELD: f32 = 0.62;
const NEAR: f32 = 0.05;
/// Behind the haze nothing is drawn: so much, and so many distances.
const FAR: [f32; 2] = [600.0, 20.0];
/// Pitches that keep the eye above the ground and off the pole, rad.
pub const PITCH: [f32; 2] = [0.02, 1.55];
/// Distances, m.
pub const DISTANCE: [f32; 2] = [0.5, 2000.0];

/// Fraction of the way to a character that a camera in a film or a window covers in a frame.
pub const FOLLOW: f32 = 0.2;

/// How much further the camera is for each metre of the way from the middle of a company to who is farthest, in a
/// picture as wide as it is high: so much that all are in it, wherever they stand to each other.
const WIDE: f32 = 2.5;

/// A camera on a sphere around the point it looks at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// m
    pub focus: Vec3,
    /// Turn of the eye around the vertical; 0 sees the focus from its +z, rad.
    pub yaw: f32,
    /// Height of the eye as an angle, rad.
    pub pitch: f32,
    /// m
    pub distance: f32,
    /// What part of the distance is there for a company's sake, m: see [`Camera::frame`].
    pub wider: f32,
}

impl Default for Camera {
    fn default() -> Self {
        Camera {
            focus: Vec3::new(0.0, 0.85, 0.0),
            yaw: 0.7,
            pitch: 0.28,
            distance: 5.5,
            wider: 0.0,
        }
    }
}

impl Camera {
    /// Position of the camera, m.
    pub fn eye(&self) -> Vec3 {
        let (up, out) = self.pitch.sin_cos();
        let (x, z) = self.yaw.sin_cos();
        self.focus + self.distance * Vec3::new(out * x, up, out * z)
    }

    /// World to clip space, for a picture `aspect` times as wide as high.
    pub fn clip(&self, aspect: f32) -> Mat4 {
        perspective(FIELD, aspect, NEAR, FAR[0] + FAR[1] * self.distance)
            * look_at_mat4(self.eye(), self.focus, Vec3::Y)
    }

    /// Turns around the focus, rad.
    pub fn orbit(&mut self, yaw: f32, pitch: f32) {
        self.yaw += yaw;
        self.pitch = (self.pitch + pitch).clamp(PITCH[0], PITCH[1]);
    }

    /// Multiplies the distance by a factor, within limits.
    pub fn zoom(&mut self, factor: f32) {
        self.distance = (self.distance * factor).clamp(DISTANCE[0], DISTANCE[1]);
        self.wider *= factor;
    }

    /// Goes a fraction of the way to look at a point on the ground.
    pub fn follow(&mut self, at: [f32; 2], fraction: f32) {
        let there = Vec3::new(at[0], self.focus.y, at[1]);
        self.focus += fraction * (there - self.focus);
    }

    /// Goes a fraction of the way to look at a company around a point on the ground, who are `side` metres from it at
    /// most, in a picture `aspect` times as wide as high.
    pub fn frame(&mut self, at: [f32; 2], side: f32, aspect: f32, fraction: f32) {
        self.follow(at, fraction);
        let more = fraction * (WIDE / aspect.min(1.8) * side - self.wider);
        self.wider += more;
        self.distance = (self.distance + more).clamp(DISTANCE[0], DISTANCE[1]);
    }

    /// Moves the focus over the ground: to the right of the picture and away from the eye, m.
    pub fn pan(&mut self, right: f32, away: f32) {
        self.focus += self.over_ground([right, away]);
    }

    /// A way over the ground in the scene: to the right of the picture and away from the eye, m.
    pub fn over_ground(&self, [right, away]: [f32; 2]) -> Vec3 {
        let (sin, cos) = self.yaw.sin_cos();
        Vec3::new(cos * right - sin * away, 0.0, -sin * right - cos * away)
    }

    /// What is seen at a point of the picture, from (-1, -1) at the lower left to (1, 1).
    pub fn ray(&self, place: Vec2, aspect: f32) -> Ray {
        let back = self.clip(aspect).inverse();
        let [near, far] = [0.0, 1.0].map(|depth| back.project_point3(place.extend(depth)));
        Ray {
            from: near,
            along: (far - near).normalize_or(Vec3::NEG_Y),
        }
    }
}

/// A half line through a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// m
    pub from: Vec3,
    /// A unit vector.
    pub along: Vec3,
}

impl Ray {
    /// Where it meets the ground; `None` above the horizon.
    pub fn ground(&self) -> Option<[f32; 2]> {
        let hit = self.plane(Vec3::ZERO, Vec3::Y)?;
        Some([hit.x, hit.z])
    }

    /// Where it meets a plane through a point.
    pub fn plane(&self, point: Vec3, normal: Vec3) -> Option<Vec3> {
        let far = normal.dot(point - self.from) / normal.dot(self.along);
        (far.is_finite() && far > 0.0).then(|| self.from + far * self.along)
    }

    /// Its distance from a point, m.
    pub fn distance(&self, point: Vec3) -> f32 {
        let far = self.along.dot(point - self.from).max(0.0);
        (self.from + far * self.along).distance(point)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ground_under_a_pixel_is_drawn_at_that_pixel() {
        let mut camera = Camera::default();
        camera.orbit(1.3, 0.4);
        camera.follow([3.0, -2.0], 0.5);
        for place in [
            Vec2::new(0.0, -0.2),
            Vec2::new(-0.7, -0.9),
            Vec2::new(0.4, 0.1),
        ] {
            let [x, z] = camera.ray(place, 1.6).ground().expect("below the horizon");
            let back = camera.clip(1.6).project_point3(Vec3::new(x, 0.0, z));
            assert!((back.truncate() - place).length() < 1e-3, "{place} {back}");
        }
        camera.pitch = 0.0;
        assert_eq!(camera.ray(Vec2::new(0.0, 0.9), 1.6).ground(), None);
    }

    #[test]
    fn up_is_up_and_a_camera_in_front_sees_the_left_side_on_its_right() {
        let camera = Camera {
            yaw: 0.0,
            ..Camera::default()
        };
        let clip = camera.clip(1.0);
        let seen = |at: Vec3| clip.project_point3(at);
        assert!(seen(camera.focus + Vec3::Y).y > 0.1);
        assert!(seen(camera.focus + Vec3::X).x > 0.1);
    }
}
