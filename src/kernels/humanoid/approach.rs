//! Reward for the way to what is far. `shaders/shared/approach.wgsl` has the same function.

/// Speed at which it is largest, m/s.
const QUICK: f32 = 1.5;

/// A sum with a slope everywhere, up to 1: the papers' products are nothing for who stands far away or is turned
/// away. It moves `along` m/s towards what is `distance` m away, and faces it as much as `facing` from 0 to 1 says.
pub fn approach(along: f32, facing: f32, distance: f32) -> f32 {
    0.6 * (along / QUICK).clamp(-0.3, 1.0) + 0.2 * facing + 0.2 / (1.0 + distance)
}
