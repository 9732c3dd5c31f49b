//! The kernels of the simulated body.
//! Oracle: the twins. Environments of one humanoid, of two, of one with a box, and of what humanoids do
//! not have, in random states near the ground, drives at and below their limits.
//! Bar: rounding, as a part of the largest number of a section of an environment.

mod collision;
mod contact_forces;
mod make_constraints;
mod proprioception;
mod random_targets;
mod reset_worlds;
mod smooth_dynamics;
mod solve_and_integrate;
pub mod worlds;
