//! Arms and legs of a skeleton.

use super::roles::Roles;
use super::skeleton::Skeleton;

/// The joints to look at: shoulder, elbow and hand, hip and foot, left then right.
pub struct Limbs {
    /// Shoulder, elbow, hand.
    pub arms: [[usize; 3]; 2],
    /// Hip, foot.
    pub legs: [[usize; 2]; 2],
}

impl Limbs {
    /// None for a skeleton without arms below the shoulder.
    pub fn of(skeleton: &Skeleton, roles: &Roles) -> Option<Limbs> {
        let below = |joint: usize| skeleton.parents.iter().position(|&p| p == Some(joint));
        let arm = |shoulder: usize| {
            let elbow = below(shoulder)?;
            Some([shoulder, elbow, below(elbow)?])
        };
        Some(Limbs {
            arms: [arm(roles.left_shoulder)?, arm(roles.right_shoulder)?],
            legs: [
                [roles.left_hip, roles.left_foot],
                [roles.right_hip, roles.right_foot],
            ],
        })
    }
}
