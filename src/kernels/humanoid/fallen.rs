//! Whether a character has fallen; `shaders/shared/fallen.wgsl` has the same function.

use crate::physics::pose::Pose;

/// When a character has fallen. Bodies are counted from its first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FallRules {
    /// How many bodies it has.
    pub bodies: u32,
    /// Index of the head.
    pub head: u32,
    /// Index of the pelvis.
    pub pelvis: u32,
    /// Indices of the feet.
    pub feet: [u32; 2],
    /// Height of the head below which it has fallen, m.
    pub min_head: f32,
    /// Height of the pelvis below which it has fallen, m.
    pub min_pelvis: f32,
    /// Height of any body but the feet below which it has fallen, m.
    pub min_body: f32,
}

/// Whether a part of the body is lower than it is when standing. The character's `poses` come first.
pub fn has_fallen(poses: &[Pose], rules: &FallRules) -> bool {
    let height = |body: u32| poses[body as usize].position.z;
    height(rules.head) < rules.min_head
        || height(rules.pelvis) < rules.min_pelvis
        || (0..rules.bodies)
            .any(|body| !rules.feet.contains(&body) && height(body) < rules.min_body)
}
