//! Spatial vectors and inertias, in world axes about one origin a tree: the root body's position, so
//! that single precision suffices anywhere (Featherstone, "Rigid Body Dynamics Algorithms", ch. 2).

use glam::{Mat3, Vec3};
use std::ops::{Add, AddAssign, Mul};

/// A motion (angular, linear at the origin) or a force (torque about the origin, force).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spatial {
    /// Angular velocity, rad/s, or torque about the origin, Nm.
    pub angular: Vec3,
    /// Velocity at the origin, m/s, or force, N.
    pub linear: Vec3,
}

impl Spatial {
    /// No motion, or no force.
    pub const ZERO: Spatial = Spatial {
        angular: Vec3::ZERO,
        linear: Vec3::ZERO,
    };

    /// The rate of change of a motion that is carried along with `self`.
    #[inline]
    pub fn cross_motion(self, motion: Spatial) -> Spatial {
        Spatial {
            angular: self.angular.cross(motion.angular),
            linear: self.linear.cross(motion.angular) + self.angular.cross(motion.linear),
        }
    }

    /// The rate of change of a force, or momentum, that is carried along with `self`.
    #[inline]
    pub fn cross_force(self, force: Spatial) -> Spatial {
        Spatial {
            angular: self.angular.cross(force.angular) + self.linear.cross(force.linear),
            linear: self.angular.cross(force.linear),
        }
    }

    /// Power of a force along a motion.
    #[inline]
    pub fn dot(self, other: Spatial) -> f32 {
        self.angular.dot(other.angular) + self.linear.dot(other.linear)
    }

    /// Velocity, in a motion, of the point at `arm` from the origin.
    #[inline]
    pub fn at(self, arm: Vec3) -> Vec3 {
        self.linear + self.angular.cross(arm)
    }
}

impl Add for Spatial {
    type Output = Spatial;
    #[inline]
    fn add(self, other: Spatial) -> Spatial {
        Spatial {
            angular: self.angular + other.angular,
            linear: self.linear + other.linear,
        }
    }
}

impl AddAssign for Spatial {
    #[inline]
    fn add_assign(&mut self, other: Spatial) {
        *self = *self + other;
    }
}

impl Mul<f32> for Spatial {
    type Output = Spatial;
    #[inline]
    fn mul(self, factor: f32) -> Spatial {
        Spatial {
            angular: self.angular * factor,
            linear: self.linear * factor,
        }
    }
}

/// Inertia of a rigid body, or of several that move as one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Inertia {
    /// Total mass, kg.
    pub mass: f32,
    /// Mass times centre of mass from the origin, kg m.
    pub moment: Vec3,
    /// About the origin, kg m^2.
    pub rotation: Mat3,
}

impl Inertia {
    /// `about_centre` along world axes, about the centre of mass at `centre` from the origin.
    #[inline]
    pub fn new(mass: f32, centre: Vec3, about_centre: Mat3) -> Inertia {
        let outer = Mat3::from_cols(centre * centre.x, centre * centre.y, centre * centre.z);
        let steiner = Mat3::from_diagonal(Vec3::splat(centre.length_squared())) - outer;
        Inertia {
            mass,
            moment: centre * mass,
            rotation: about_centre + steiner * mass,
        }
    }

    /// Momentum of a motion: angular about the origin, linear.
    #[inline]
    pub fn momentum(&self, motion: Spatial) -> Spatial {
        Spatial {
            angular: self.rotation * motion.angular + self.moment.cross(motion.linear),
            linear: motion.linear * self.mass + motion.angular.cross(self.moment),
        }
    }
}

impl AddAssign for Inertia {
    #[inline]
    fn add_assign(&mut self, other: Inertia) {
        self.mass += other.mass;
        self.moment += other.moment;
        self.rotation += other.rotation;
    }
}
