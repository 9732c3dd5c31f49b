//! A policy as files carry it: a graph, and what is said of it.
//!
//! [`graph`] is a computation of ONNX's operators, [`network`] that of an actor, [`description`] all that a
//! program must know to run it. [`locomotion`] and [`body`] put them together for the kinds of tasks.

mod body;
mod body_description;
mod description;
mod exported;
pub mod graph;
mod locomotion;
mod network;

pub use exported::ExportedPolicy;

use super::format::TrainedRun;
use crate::train::task::Unsupported;
use crate::train::tasks::find;
use anyhow::Result;
use description::PolicyDescription;

/// The policy of a run.
///
/// # Errors
/// Its task is of no kind that there is.
pub fn export_policy(run: &TrainedRun) -> Result<ExportedPolicy> {
    let header = &run.checkpoint.header;
    let settings = serde_json::to_value(run.task.settings())?;
    let about = PolicyDescription::new(header, find(&header.task)?.about, settings);
    match (run.task.locomotion(), run.task.body()) {
        (Some(own), _) => Ok(locomotion::export(run, own, about)),
        (None, Some(own)) => Ok(body::export(run, &own, about)),
        (None, None) => {
            let why = format!("policies of `{}` cannot be exported", header.task);
            Err(Unsupported(why).into())
        }
    }
}
