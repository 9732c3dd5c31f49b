//! Metres per file unit, found from the length of the legs.
//!
//! BVH files do not say their unit. A grown person's leg, the straight length from the top of
//! the thigh to the ankle, measures 0.75 to 0.95 m; it is the same in every pose, so unlike the
//! height of the hips it needs neither a standing frame nor a known floor. The units in use lie
//! more than a factor of 2.1 apart, so at most one of them gives a leg of 0.55 to 1.15 m. If
//! none does, the skeleton is scaled to a leg of 0.85 m.

use super::error::{MotionError, MotionResult};
use super::roles::Roles;
use super::skeleton::Skeleton;

/// Metre, foot, the unit of CMU's files (an inch / 0.45), inch, centimetre, millimetre.
pub const COMMON: [f32; 6] = [1.0, 0.3048, 0.056444, 0.0254, 0.01, 0.001];

const LEGS: std::ops::Range<f32> = 0.55..1.15;
const USUAL_LEG: f32 = 0.85;
/// No body has legs outside of this, m: a unit that says so is a mistake.
const POSSIBLE_LEGS: std::ops::Range<f32> = 0.05..20.0;

/// Metres per unit of a skeleton whose lengths are in file units: one of [`COMMON`] if one
/// fits, else whatever makes the legs 0.85 m long.
///
/// Errors: legs without length.
pub fn find(skeleton: &Skeleton, roles: &Roles) -> MotionResult<f32> {
    let leg = leg(skeleton, roles);
    if !(leg.is_finite() && leg > 1e-6) {
        return Err(MotionError::Unit {
            problem: format!("the legs are {leg} units long"),
        });
    }
    let fits = |unit: &f32| LEGS.contains(&(unit * leg));
    Ok(COMMON.into_iter().find(fits).unwrap_or(USUAL_LEG / leg))
}

/// Refuses a given unit that cannot be meant.
pub fn check(unit: f32, skeleton: &Skeleton, roles: &Roles) -> MotionResult<()> {
    let leg = unit * leg(skeleton, roles);
    if POSSIBLE_LEGS.contains(&leg) {
        return Ok(());
    }
    Err(MotionError::Unit {
        problem: format!("with {unit} m the legs would be {leg} m long"),
    })
}

/// Mean length of the two chains from the top of the thigh to the ankle, in the skeleton's unit.
pub fn leg(skeleton: &Skeleton, roles: &Roles) -> f32 {
    let left = skeleton.reach(roles.left_hip, roles.left_foot);
    let right = skeleton.reach(roles.right_hip, roles.right_foot);
    (left + right) / 2.0
}
