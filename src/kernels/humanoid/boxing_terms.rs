//! Terms of the reward of boxing, equations 11 to 19 of Son and Kwon (2023), whose printed "min" in 14, 15 and 17
//! are lower bounds. `shaders/shared/boxing_terms.wgsl` has the same functions.
//!
//! Directions are unit vectors on the ground; `ahead` is the cosine between a fighter's heading and the direction
//! to its opponent. What is printed in the exponent as a squared norm is a square.

use glam::Vec3;

/// Distance within which fighters may spend as much as they like, m (equation 18).
const REACH: f32 = 1.0;
/// Least damage of a step, N (equation 15).
const LEAST_DAMAGE: f32 = -200.0;

/// Reward of who is far from its opponent (equation 11).
pub fn far(position: f32, velocity: f32, facing: f32) -> f32 {
    0.5 * position + 0.4 * velocity + 0.1 * facing
}

/// Reward for being near, at a `distance` of so many metres (equation 12).
pub fn position(distance: f32) -> f32 {
    (-0.5 * distance * distance).exp()
}

/// Reward for moving towards the opponent, `along` m/s, at the `wanted` speed or faster (equation 13).
pub fn velocity(along: f32, wanted: f32) -> f32 {
    let short = (wanted - along).max(0.0);
    (-4.0 * short * short).exp()
}

/// Reward for facing the opponent from afar (equation 14).
pub fn facing_from_afar(ahead: f32) -> f32 {
    ahead.max(0.0)
}

/// Reward for the forces given and taken in a step, N, of which those taken count `factor` times (equation 15, whose
/// factor is 2).
pub fn damage(given: f32, taken: f32, factor: f32) -> f32 {
    (given - factor * taken).max(LEAST_DAMAGE)
}

/// Reward for a hand that is `apart`, m, from the nearer of its targets, and moves towards the opponent with
/// `along` m/s (equations 2 to 4).
pub fn close(apart: Vec3, along: f32) -> f32 {
    0.2 * (-4.0 * apart.length_squared()).exp() + 0.8 * along.clamp(0.0, 1.0)
}

/// Whether two fighters face each other: back to back the directions of equation 16 agree as well.
pub fn face_each_other(ahead: f32, opponent_ahead: f32) -> bool {
    ahead > 0.0 && opponent_ahead > 0.0
}

/// Reward for facing each other (equation 16): `alignment` is the cosine between each fighter's direction to the
/// other, as it sees it in its own heading frame.
pub fn facing(alignment: f32, face_each_other: bool) -> f32 {
    match face_each_other {
        true => (-5.0 * (alignment - 1.0).abs()).exp(),
        false => 0.0,
    }
}

/// Reward for an opponent that is about to fall, `up` being its up axis along the world's (equation 17).
pub fn fall(up: f32) -> f32 {
    0.6 * (1.0 - up).max(0.0)
}

/// How much energy counts at a `distance` of so many metres (equation 18).
pub fn nearness(distance: f32) -> f32 {
    let beyond = (distance - REACH).max(0.0);
    (-10.0 * beyond * beyond).exp()
}

/// Cost of the energy that a sum of squared accelerations of all joints, rad^2/s^4, stands for (equation 19).
pub fn energy(distance: f32, squared_acceleration: f32) -> f32 {
    nearness(distance) * squared_acceleration
}

/// Penalties of who has fallen, and of who has left the arena.
pub fn penalty(fallen: bool, out: bool) -> f32 {
    f32::from(u8::from(fallen)) + f32::from(u8::from(out))
}
