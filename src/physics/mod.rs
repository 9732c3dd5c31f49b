//! The simulated body: articulated rigid bodies with soft contact, as MuJoCo defines them.
//!
//! - [`model`]: trees of bodies as flat arrays, the way everything below reads them;
//! - [`mjcf`], [`humanoid`], [`assemble`], [`scenes`]: where models come from;
//! - [`pose`], [`spatial`], [`invweight0`]: what the others compute with;
//! - [`kinematics`], [`dynamics`], [`factor`], [`drive`]: from a state to accelerations without contact;
//! - [`collision`], [`constraints`], [`pgs`]: contacts and joint limits, and the forces they take;
//! - [`integrate`], [`simulator`]: a step of one world, from beginning to end;
//! - [`motion_clip`], [`footing`], [`mirror`]: a recording of the body, on the ground and mirrored;
//! - [`retarget`], [`deepmimic`]: where such recordings come from;
//! - [`skeleton_clip`]: what becomes of them elsewhere;
//! - [`motion_library`], [`motion_list`]: what to draw from, and the files that make it up.

pub mod assemble;
pub mod collision;
pub mod constraints;
pub mod deepmimic;
pub mod drive;
pub mod dynamics;
pub mod factor;
pub mod footing;
pub mod humanoid;
pub mod integrate;
pub mod invweight0;
pub mod kinematics;
pub mod mirror;
pub mod mjcf;
pub mod model;
pub mod motion_clip;
pub mod motion_library;
pub mod motion_list;
pub mod pgs;
pub mod pose;
pub mod retarget;
pub mod scenes;
pub mod simulator;
pub mod skeleton_clip;
pub mod spatial;
