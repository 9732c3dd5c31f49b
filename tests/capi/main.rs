//! Characters stepped from a loop of one's own, and the C interface to them. What C itself can do wrong,
//! `tests/capi/run` tries.

mod allocations;
mod characters;
mod place;
