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
//! - [`motion`]: recordings, the procedural performer, features, the database;
//! - [`gpu`]: devices, buffers, the one launch, the one bridge to burn's tensors;
//! - [`kernels`]: one file a shader: parameters, launch, twin;
//! - [`search`]: the exact search's index, and the search on the CPU;
//! - [`world`]: a batch of worlds, by shaders or by twins;
//! - [`body`]: articulated rigid bodies with contact: models, and the physics of one world;
//! - [`simulation`]: a batch of physical worlds, by shaders or by their twins' functions;
//! - [`playback`]: the whole body of a walk: stitching, foot locking, and how good it looks;
//! - [`ppo`]: policy, rollout, update;
//! - [`train`]: configuration, run folder, checkpoints, the loop, evaluation;
//! - [`view`]: scenes, and the renderer that draws them on the GPU or on lavapipe;
//! - [`play`]: the window: a controller at work, and why it does what it does;
//! - [`benchmark`]: what each device makes of each stage;
//! - [`report`]: pictures, TensorBoard events, tables;
//! - [`store`] and [`tensors`]: files and tensors as plain arrays.

pub mod benchmark;
pub mod body;
pub mod gpu;
pub mod kernels;
pub mod motion;
pub mod play;
pub mod playback;
pub mod ppo;
pub mod report;
pub mod search;
pub mod simulation;
pub mod store;
pub mod tensors;
pub mod train;
pub mod view;
pub mod world;
