//! Why a recording cannot be put into a body.

use crate::motion::error as motion;
use crate::physics::humanoid;

pub type Result<T> = std::result::Result<T, RetargetError>;

/// Why a recording cannot be put into a body.
#[derive(Debug, thiserror::Error)]
pub enum RetargetError {
    #[error(transparent)]
    Motion(#[from] motion::MotionError),
    #[error(
        "the model '{model}' has no {kind} joint on a body '{body}': recordings are for bodies like the \
         humanoid, whose parts are called {}", humanoid::BODIES.join(", ")
    )]
    Model {
        model: String,
        body: String,
        kind: &'static str,
    },
    #[error(
        "the feet of the model '{model}' have no geom that touches anything: give one to 'right_foot' or 'left_foot'"
    )]
    Feet { model: String },
    #[error("the clip '{clip}' has {frames} frames, but a motion needs at least 2")]
    Short { clip: String, frames: usize },
    #[error(
        "unknown skeleton: {problem}; its joints are {joints}. Give a roles file that names other joints"
    )]
    Skeleton { problem: String, joints: String },
}
