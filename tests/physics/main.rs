//! The simulated body: the model reader, dynamics, contacts and the solver against MuJoCo (golden files
//! made by `tests/reference`) and against mechanics, and motion put into the body.

mod collide;
mod contacts;
mod dynamics;
mod golden;
mod laws;
#[path = "../support/mocap.rs"]
mod mocap;
mod model;
mod motion_list;
mod retarget;
mod statistics;
