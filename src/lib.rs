//! Footwork trains character controllers: motion capture in, a policy that steers a full-body
//! character out, by motion matching and PPO (Lee, Kwon, Shin and Lee, "Utilizing Motion Matching
//! with Deep Reinforcement Learning for Target Location Tasks"); and simulated bodies that learn to
//! move, on articulated-body physics of its own.
//!
//! # A step of motion matching
//!
//! Every 0.2 seconds the policy observes the pose feature of the frame that its character shows and
//! the target in the character frame. Its action is half a query: where the character should be, and
//! face, in a third, two thirds and a whole second. The pose feature is the other half. The search
//! finds the database frame nearest to the whole query; the six frames that follow it are played, and
//! the reward is for being near the target. No joint takes part in this: the state of an environment
//! is a frame number, a position on the ground and a heading. Thousands of environments step side by
//! side, in shaders on a GPU or in the shaders' twins on a CPU, and after a few steps PPO learns from
//! all of them at once, on the same device.
//!
//! ```
//! # #[cfg(feature = "train")] {
//! use footwork::prelude::*;
//! use std::sync::Arc;
//!
//! let (clips, roles) = synthetic::perform(1, 1.0);
//! let database = Database::build(&clips, roles, Weights::PAPER)?;
//! let matcher = Arc::new(MotionMatcher::new(Arc::new(database)));
//!
//! let ppo = Ppo::default();
//! let task = LocomotionTask::Plane(Plane::default());
//! let config = EnvConfig { task, envs: ppo.envs, seed: 1, level: 0 };
//! let mut envs = config.open(&Device::Cpu, &matcher)?;
//! let mut learner = PpoLearner::new(&ppo, &envs, &Device::Cpu, 1)?;
//! for update in 0..3 {
//!     let iteration = learner.iterate(&mut envs, update * ppo.batch() as u64)?;
//!     println!("{:?}", iteration.stats.mean("returns"));
//! }
//! let policy = learner.policy()?;
//! assert_eq!(policy.mean(&[0.0; 17]).len(), 12);
//! # }
//! # Ok::<(), anyhow::Error>(())
//! ```
//!
//! # The modules, from the ground up
//!
//! - [`gpu`]: devices, arrays, the one launch, the one bridge to burn's tensors;
//! - [`motion`]: recordings, the synthetic performer, features, the database;
//! - [`physics`]: articulated rigid bodies with contact, one world at a time;
//! - [`kernels`]: one file per shader: parameters, launch, twin;
//! - [`matching`]: motion matching: the exact search and its index, on the CPU and on the GPU;
//! - [`playback`]: the whole body of an episode: stitching, foot locking, motion quality;
//! - `nn`: networks, their evaluation and their gradients (feature `train`);
//! - `env`: batches of environments behind one trait: motion matching, simulated bodies (`train`);
//! - `ranks`: processes that train together (`train`; over MPI with `mpi`);
//! - `rl`: rollouts, advantages, PPO (`train`);
//! - `train`: tasks by name, configuration, run directory, checkpoints, evaluation (`train`);
//! - `runtime`: trained characters, stepped from somebody's own loop (`train`);
//! - `capi`: the same from C, for game engines (`capi`);
//! - `view`: scenes (`train`) and the renderer that draws them (`viewer`);
//! - `viewer`: windows (`viewer`);
//! - `export`: policies, motion and models in files of other programs (`export`);
//! - `web`: a run in a browser: its files, and the page that plays them (`train`);
//! - `bench`: what each device makes of each stage (`viewer`);
//! - [`report`]: tables; pictures and TensorBoard events (feature `report`);
//! - [`prelude`]: the names that most programs begin with;
//! - [`container`]: the file format of databases and checkpoints; [`input_file`]: files that users name.
//!
//! # Examples
//!
//! In `examples/`, in the order in which to read them; none needs a file: `match_one_query`, `step_a_batch`,
//! `train_tiny`, `drive_a_character`, `task_of_your_own`, `physics_of_your_own`.
//!
//! # Features
//!
//! All of `capi`, `cli`, `export`, `gpu`, `report`, `train` and `viewer` are on by default. Without any of them the crate
//! is motion matching and physics on the CPU, without burn, wgpu or a command line. `train,cli` trains on
//! the CPU; `mpi` lets ranks train together. No real GPU has been measured yet: the shaders are tested on Mesa's lavapipe.

#![warn(missing_docs, clippy::print_stdout, clippy::print_stderr)]
#![allow(rustdoc::private_intra_doc_links)]

#[cfg(feature = "viewer")]
pub mod bench;
#[cfg(feature = "capi")]
pub mod capi;
pub mod container;
#[cfg(feature = "train")]
pub mod env;
#[cfg(feature = "export")]
pub mod export;
pub mod gpu;
pub mod input_file;
pub mod kernels;
pub mod matching;
pub mod motion;
#[cfg(feature = "train")]
pub mod nn;
pub mod physics;
pub mod playback;
pub mod prelude;
#[cfg(feature = "train")]
pub mod ranks;
pub mod report;
#[cfg(feature = "train")]
pub mod rl;
#[cfg(feature = "train")]
pub mod runtime;
#[cfg(feature = "train")]
pub mod train;
#[cfg(feature = "train")]
pub mod view;
#[cfg(feature = "viewer")]
pub mod viewer;
#[cfg(feature = "train")]
pub mod web;
