//! Learning: [`sample_action`] draws actions, [`gae`] computes advantages. A gradient step of dense
//! networks, in order: [`forward`], [`mod@loss`], [`backward`], [`mod@gradient`], [`reduce_grads`],
//! [`adam`]; [`network`] defines their memory layout.

pub mod adam;
pub mod backward;
pub mod forward;
pub mod gae;
pub mod gather_samples;
pub mod gradient;
pub mod loss;
pub mod network;
pub mod reduce_grads;
pub mod rollout_moments;
pub mod sample_action;
