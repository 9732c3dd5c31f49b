//! Simulated humanoids: [`batch`] steps their physics, tasks stand on it. [`stand`] is to stay upright.
//!
//! [`action`] says what an action means, [`starts`] where episodes begin.

pub mod action;
pub mod batch;
pub mod stand;
pub mod starts;
