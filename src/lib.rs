//! Footwork trains character controllers: motion capture in, a policy that steers a full-body
//! character out, by motion matching and PPO (Lee, Kwon, Shin and Lee, "Utilizing Motion Matching
//! with Deep Reinforcement Learning for Target Location Tasks").
//!
//! # A step
//!
//! Every 0.2 seconds the policy sees the pose feature of the frame its character shows and the
//! target in the character's frame. It answers with half a question: where the character should be,
//! and face, in a third, two thirds and a whole second. The pose feature is the other half. The
//! search finds the database frame nearest to the whole question; the six frames that follow it are
//! played; the character stands where they have taken it, and is rewarded for being near its target.
//! Nothing of this touches a joint: the world of the policy is a frame number, a place on the ground
//! and a direction. Thousands of such worlds step side by side, in shaders on a GPU or in the
//! shaders' twins on a CPU, and after a few steps PPO learns from all of them at once, on the same
//! device.
//!
//! # The modules, from the ground up
//!
//! - [`motion`]: recordings, the synthetic performer, features, the database;
//! - [`gpu`]: devices, buffers, the one launch, the one bridge to burn's tensors;
//! - [`kernels`]: one file per shader: parameters, launch, twin;
//! - [`matching`]: motion matching: the exact search, its index, on the CPU and on the GPU;
//! - [`physics`]: articulated rigid bodies with contact;
//! - [`nn`]: networks, their evaluation and their gradients;
//! - [`env`]: batches of environments, by shaders or by their twins;
//! - [`rl`]: rollouts, advantages, PPO;
//! - [`train`]: configuration, run directory, checkpoints, the loop, evaluation;
//! - [`playback`]: the whole body of an episode: stitching, foot locking, motion quality;
//! - [`view`]: scenes, and the renderer that draws them;
//! - [`viewer`]: the interactive windows;
//! - [`bench`]: what each device makes of each stage;
//! - [`report`]: pictures, TensorBoard events, tables;
//! - [`container`]: the file format of databases and checkpoints.

pub mod bench;
pub mod container;
pub mod env;
pub mod gpu;
pub mod kernels;
pub mod matching;
pub mod motion;
pub mod nn;
pub mod physics;
pub mod playback;
pub mod report;
pub mod rl;
pub mod train;
pub mod view;
pub mod viewer;
