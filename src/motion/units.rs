//! Metres per file unit, found from the length of the legs.
//!
//! BVH files do not say their unit. A grown person's leg, the straight length from the top of
//! the thigh to the ankle, measures 0.75 to 0.95 m; it is the same in every pose, so unlike the
//! height of the hips it needs neither a standing frame nor a known floor. The units in use lie
//! more than a factor of 1.7 apart, so at most one of them gives a leg of 0.7 to 1.05 m. If
//! none does, the person is small or large, and the unit the commonest that is possible at all; else
//! the skeleton is scaled to a leg of 0.85 m. The files of a folder come from one program and have
//! one unit, whoever was recorded.

use super::error::{MotionError, MotionResult};
use super::roles::Roles;
use super::skeleton::Skeleton;

/// Metre, foot, decimetre, the unit of CMU's files (an inch / 0.45), inch, centimetre, millimetre.
pub const COMMON: [f32; 7] = [1.0, 0.3048, 0.1, 0.056444, 0.0254, 0.01, 0.001];

/// Those that are believed of small and large people too.
const COMMONEST: [f32; 2] = [1.0, 0.01];

/// Legs of grown people, m.
const USUAL_LEGS: std::ops::Range<f32> = 0.7..1.05;
/// Legs from a child's to a giant's, m.
const UNUSUAL_LEGS: std::ops::Range<f32> = 0.25..1.4;
/// Legs for which a unit that is rarer than metres and centimetres is believed, m.
const LIKELY_LEGS: std::ops::Range<f32> = 0.55..1.15;
const GROWN_LEG: f32 = 0.85;
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
    let fits = |units: &[f32], legs: std::ops::Range<f32>| {
        units
            .iter()
            .copied()
            .find(|unit| legs.contains(&(unit * leg)))
    };
    let unit = fits(&COMMON, USUAL_LEGS)
        .or_else(|| fits(&COMMONEST, UNUSUAL_LEGS))
        .or_else(|| fits(&COMMON, LIKELY_LEGS));
    Ok(unit.unwrap_or(GROWN_LEG / leg))
}

/// One unit for the skeletons of one folder, out of those that each alone would have: the one with
/// which most legs are a grown person's, if with it nobody's are beyond a child's or a giant's.
/// `legs` are in file units, each with its own unit.
pub fn common(legs: &[(f32, f32)]) -> Option<f32> {
    let within = |unit: f32, range: std::ops::Range<f32>| {
        legs.iter()
            .filter(|(leg, _)| range.contains(&(unit * leg)))
            .count()
    };
    let votes = |unit: f32| within(unit, USUAL_LEGS);
    let units = legs.iter().map(|&(_, unit)| unit);
    // The first of equals wins.
    let best = units.reduce(|best, unit| {
        if votes(unit) > votes(best) {
            unit
        } else {
            best
        }
    })?;
    let alike = legs.iter().all(|&(_, unit)| unit == best);
    (alike || within(best, UNUSUAL_LEGS) == legs.len()).then_some(best)
}

/// What is unusual about legs of so many units, where the unit was found.
pub fn remark(leg: f32, unit: f32) -> Option<String> {
    let metres = leg * unit;
    if !COMMON.contains(&unit) {
        return Some(format!(
            "no usual unit fits, scaled by {unit} for legs of {metres:.2} m"
        ));
    }
    let figures = format!("legs of {metres:.2} m with a unit of {unit} m");
    let mut others = COMMONEST.into_iter().filter(|&other| other != unit);
    let other = others.find(|other| UNUSUAL_LEGS.contains(&(other * leg)));
    match other {
        Some(other) => Some(format!("{figures}, or {:.2} m with {other} m", other * leg)),
        None => (!USUAL_LEGS.contains(&metres)).then_some(figures),
    }
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
