//! The whole body of a character whose policy knows only a frame number, a place and a heading.
//!
//! A rollout is a chain of [`PlacedFrame`] frames. [`Player`] turns it into poses: where the chain jumps
//! to another frame, [`stitch`] carries the difference over and lets it fade; where a foot stands,
//! [`foot_lock`] holds it in place by bending the leg ([`two_bone_ik`]). (Paper, section 6: "simple
//! motion stitching" and "analytic two-joint inverse kinematics to prevent foot sliding".) Nothing
//! here is ever seen by the policy.

pub mod contact;
pub mod foot_lock;
pub mod inertialize;
pub mod leg;
pub mod placed_frame;
pub mod player;
pub mod pose;
pub mod quality;
mod spring;
pub mod stitch;
pub mod two_bone_ik;

pub use placed_frame::PlacedFrame;
pub use player::Player;
pub use pose::CharacterPose;
