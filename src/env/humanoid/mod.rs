//! Simulated humanoids: [`batch`] steps their physics, [`task`] plays a task on it. [`stand`] is to stay
//! upright, [`imitate`] to move as recordings do, [`track`] to follow them moment
//! by moment, [`punch`] to go up to a box and topple it, [`boxing`] to fight another.
//!
//! [`action`] says what an action means, [`driver`] who acts, [`starts`] where episodes begin, [`recorded`] what
//! recordings are to a task, [`fidelity`] how motion compares with them, and [`skills`] what latents lead to.

pub mod action;
pub mod batch;
pub mod boxing;
pub mod driver;
pub mod fidelity;
pub mod imitate;
pub mod punch;
pub mod recorded;
pub mod skills;
pub mod stand;
pub mod starts;
pub mod task;
pub mod track;
