//! The C interface, for game engines: `include/footwork.h` is made of it, `docs/engines.md` tells how it is used.
//!
//! Every function says by a [`FootworkStatus`] how it went, and leaves a text for [`footwork_last_error`]. Nothing that
//! a caller passes ends the process: handles are looked up in tables, so that one that was closed, or never was,
//! is an error; panics stop here.

mod arguments;
mod characters;
mod database;
mod handles;
mod policy;
mod status;

pub use characters::{
    FootworkCharacterState, FootworkCharacters, FootworkObstacle, footwork_characters_close,
    footwork_characters_local_pose, footwork_characters_open, footwork_characters_place,
    footwork_characters_set_obstacles, footwork_characters_set_target, footwork_characters_state,
    footwork_characters_step, footwork_characters_step_all, footwork_characters_world_pose,
};
pub use database::{
    FootworkDatabase, FootworkDatabaseInfo, footwork_database_close, footwork_database_info,
    footwork_database_joint_name, footwork_database_joint_offsets, footwork_database_joint_parents,
    footwork_database_open, footwork_database_search,
};
pub use policy::{
    FootworkPolicy, FootworkPolicyInfo, footwork_policy_close, footwork_policy_info,
    footwork_policy_open,
};
pub use status::{FootworkStatus, footwork_last_error, footwork_version};
