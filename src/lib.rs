//! Footwork trains character controllers: motion capture in, a policy that steers a full-body
//! character out.

pub mod gpu;
pub mod kernels;
pub mod motion;
pub mod ppo;
pub mod report;
pub mod search;
pub mod store;
pub mod tensors;
pub mod train;
pub mod world;
