//! Why a recording cannot be put into a body.

use crate::motion::error as motion;
use crate::physics::humanoid;

/// A result of putting a recording into a body.
pub type Result<T> = std::result::Result<T, RetargetError>;

/// Why a recording cannot be put into a body.
#[derive(Debug, thiserror::Error)]
pub enum RetargetError {
    /// A fault of the recorded motion itself.
    #[error(transparent)]
    Motion(#[from] motion::MotionError),
    /// A model that lacks a body of the humanoid, or whose body has other joints.
    #[error(
        "the model '{model}' has no {kind} joint on a body '{body}': recordings are for bodies like the \
         humanoid, whose parts are called {}", humanoid::BODIES.join(", ")
    )]
    Model {
        /// Name of the model.
        model: String,
        /// Name of the body, one of [`BODIES`](humanoid::BODIES).
        body: String,
        /// The joint that the body must have: `single free`, `single ball` or `single hinge`.
        kind: &'static str,
    },
    /// A model whose feet have no geoms to stand on.
    #[error(
        "the feet of the model '{model}' have no geom that touches anything: give one to 'right_foot' or 'left_foot'"
    )]
    Feet {
        /// Name of the model.
        model: String,
    },
    /// A clip of fewer than two frames, which has no velocities.
    #[error("the clip '{clip}' has {frames} frames, but a motion needs at least 2")]
    Short {
        /// Name of the clip.
        clip: String,
        /// Number of frames once resampled.
        frames: usize,
    },
    /// A skeleton in which an elbow, wrist or knee is not found.
    #[error(
        "unknown skeleton: {problem}; its joints are {joints}. Give a roles file that names other joints"
    )]
    Skeleton {
        /// What is missing, and below which joint.
        problem: String,
        /// Names of the skeleton's joints, separated by commas.
        joints: String,
    },
}
