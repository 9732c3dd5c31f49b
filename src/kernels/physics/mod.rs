//! A step of the articulated bodies, in order: [`smooth_dynamics`] computes poses, the factored mass
//! matrix and the unconstrained acceleration, [`collision`] detects contacts, [`make_constraints`]
//! builds the rows of contacts and limits, [`solve_and_integrate`] finds their forces and advances the
//! state, [`contact_forces`] sums forces over bodies and pairs. [`random_targets`] draws random actions,
//! [`reset_worlds`] restarts environments, [`proprioception`] observes a character's body. All read the
//! [`model_table`].

pub mod collision;
pub mod contact_forces;
pub mod make_constraints;
pub mod model_table;
pub mod proprioception;
pub mod random_targets;
pub mod reset_worlds;
pub mod smooth_dynamics;
pub mod solve_and_integrate;
pub mod strided;
