//! Bouts between a learner and its opponents: [`group_bouts`] gives every policy among these rows of its own,
//! [`opponent_input`] is what they observe there, [`scripted_actions`] are of those that follow a script, and
//! [`bout_actions`] joins all with the learner's; [`end_bouts`] counts what has ended and draws who meets next.
//! [`OpponentTable`] says whom bouts are against.

pub mod bout_actions;
pub mod end_bouts;
pub mod group_bouts;
pub mod opponent_input;
mod opponent_table;
pub mod scripted_actions;

use crate::gpu::shader::bout_actions::constants as wgsl;
use crate::kernels::learn::network::NO_COPY;
pub use opponent_table::OpponentTable;

/// In place of an environment or a policy where there is none.
pub const NOBODY: u32 = wgsl::NOBODY;
/// Added to a script's index where others have their places among the rows of policies.
pub const SCRIPTED: u32 = wgsl::SCRIPTED;

// Blocks of nobody are not evaluated.
const _: () = assert!(NOBODY == NO_COPY);
