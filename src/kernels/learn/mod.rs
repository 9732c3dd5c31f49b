//! Learning: [`sample_action`] draws actions, [`gae`] computes advantages, [`normalize_advantages`] makes them alike. The
//! gradient of narrow dense networks, in order: [`forward`], an objective such as [`ppo_loss`], [`backward`],
//! [`mod@gradient`], [`reduce_grads`]; [`network`] defines their memory layout. A step against any gradient:
//! [`adapt_lr`], [`grad_norm`], [`adam`].
//!
//! A discriminator sees [`style_windows`], and gives the [`style_reward`]; [`discriminator_loss`] is its objective.
//! Skills add [`advance_latents`], [`encoder_loss`], [`skill_reward`] and [`diversity_loss`].
//!
//! Under a high level, a low-level policy is given its [`low_level_input`]; [`keep_first_end`] and [`sum_decision`]
//! make a decision's transition of the steps that it lasts. [`gather_rows`] picks rows of any array.

pub mod adam;
pub mod adapt_lr;
pub mod advance_latents;
pub mod backward;
pub mod discriminator_loss;
pub mod diversity_loss;
pub mod encoder_loss;
pub mod forward;
pub mod gae;
pub mod gather_rows;
pub mod gather_samples;
pub mod grad_norm;
pub mod gradient;
pub mod keep_first_end;
pub mod low_level_input;
pub mod network;
pub mod normalize_advantages;
pub mod ppo_loss;
pub mod reduce_grads;
pub mod rollout_moments;
pub mod sample_action;
pub mod skill_reward;
pub mod style_reward;
pub mod style_windows;
pub mod sum_decision;
