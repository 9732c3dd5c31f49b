//! Simulated humanoids: [`batch`] steps their physics, [`task`] plays a task on it. [`stand`] is to stay
//! upright, [`imitate`] to move as recordings do, [`punch`] to go up to a box and topple it.
//!
//! [`action`] says what an action means, [`starts`] where episodes begin, [`recorded`] what recordings are to
//! a task.

pub mod action;
pub mod batch;
pub mod imitate;
pub mod punch;
pub mod recorded;
pub mod stand;
pub mod starts;
pub mod task;
