//! What tasks of the simulated humanoid add to a step of its physics: [`action_targets`] and
//! [`random_pushes`] before it; behind it the task's reward, [`end_episode`], and [`draw_starts`] for the
//! episodes that it ended. [`episode_sums`] collects statistics. The tasks `punch` and `joystick` have
//! [`place_target`], [`punch_reward`] and [`punch_observe`] over a [`punch_state`];
//! `track` has [`begin_track`], [`track_reward`] and [`track_observe`] over a [`track_state`]. The task `box` has
//! [`place_fighters`], [`joint_accelerations`], [`boxing_reward`] out of its [`boxing_terms`] and [`boxing_observe`], of
//! two [`fighters`], over a [`boxing_state`]. [`fallen`] says who lies.

pub mod action_targets;
pub mod approach;
pub mod begin_track;
pub mod boxing_observe;
pub mod boxing_reward;
pub mod boxing_state;
pub mod boxing_terms;
pub mod draw_starts;
pub mod end_episode;
pub mod episode_sums;
pub mod fallen;
pub mod fighters;
pub mod joint_accelerations;
pub mod place_fighters;
pub mod place_target;
pub mod punch_observe;
pub mod punch_reward;
pub mod punch_state;
pub mod random_pushes;
pub mod stand_reward;
pub mod track_observe;
pub mod track_reward;
pub mod track_state;
