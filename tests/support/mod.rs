//! What several test binaries share.
#![allow(dead_code, unused_macros, reason = "each binary uses a part of it")]

pub mod checked;
#[macro_use]
pub mod forms;
pub mod database;
pub mod geometry;
pub mod ground;
pub mod inputs;
pub mod low_level;
pub mod oracle;
