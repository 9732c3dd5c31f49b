//! The whole body of a character whose policy knows only a frame number, a position and a heading.
//!
//! An episode is a chain of [`PlacedFrame`]s. [`Player`] makes poses of it: where the chain jumps
//! to another frame, [`stitch`] carries the difference over and lets it decay; where a foot stands,
//! [`foot_lock`] holds it there by bending the leg ([`two_bone_ik`]). (Paper, section 6: "simple
//! motion stitching" and "analytic two-joint inverse kinematics to prevent foot sliding".) Nothing
//! here is ever seen by the policy.

pub mod capsule_rig;
pub mod colours;
pub mod contact;
pub mod foot_lock;
pub mod inertialize;
pub mod leg;
pub mod meshes;
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
