//! One file a shader: its parameters, its launch and its CPU twin, all of one name and one
//! order of arguments. The twin is the shader's oracle and the CPU backend's kernel.
//!
//! A step of the world, in order:
//! [`observe`] what the policy sees, [`act`] draw its action, [`query`] put the question to the
//! database, [`search_wide`] or [`search_tile`] and [`search_exact`] find the nearest candidate,
//! [`mod@step`] play it and reward, [`reset`] where an episode ended. After a rollout [`gae`] judges
//! the actions and [`tally`] sums up the episodes.

pub mod act;
pub mod gae;
pub mod layout;
pub mod observe;
pub mod query;
pub mod reset;
pub mod rng;
pub mod search_exact;
pub mod search_tile;
pub mod search_wide;
pub mod step;
pub mod tally;
