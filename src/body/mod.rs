//! The simulated body: articulated rigid bodies with soft contact, as MuJoCo defines them.
//!
//! - [`model`]: trees of bodies as flat arrays, the way everything below reads them;
//! - [`mjcf`], [`humanoid`], [`assemble`], [`scenes`]: where models come from;
//! - [`pose`], [`spatial`], [`looseness`]: what the others compute with;
//! - [`kinematics`], [`dynamics`], [`factor`], [`drive`]: from a state to accelerations without contact;
//! - [`collide`], [`constrain`], [`sweep`]: contacts and joint limits, and the forces they take;
//! - [`integrate`], [`physics`]: a step of one world, from beginning to end;
//! - [`motion`], [`retarget`], [`motion_library`]: recordings in the body, and what to draw from;
//! - [`tables`]: the model in words, for shaders.

pub mod assemble;
pub mod collide;
pub mod constrain;
pub mod drive;
pub mod dynamics;
pub mod factor;
pub mod humanoid;
pub mod integrate;
pub mod kinematics;
pub mod looseness;
pub mod mjcf;
pub mod model;
pub mod motion;
pub mod motion_library;
pub mod physics;
pub mod pose;
pub mod retarget;
pub mod scenes;
pub mod spatial;
pub mod sweep;
pub mod tables;
