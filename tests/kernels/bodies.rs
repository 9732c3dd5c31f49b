//! The kernels of the simulated body against their twins: what each makes of the same buffers, by its
//! own launch and through plain wgpu. Worlds of one humanoid, of two, of one with a box, and of what humanoids
//! do not have, in random states near the ground, drives at and below their limits.
//! Bar: rounding, as a part of the largest number of a section of an environment.

mod articulate;
mod blows;
mod constrain;
mod explore;
mod proprioception;
mod restart;
mod solve;
mod worlds;
