//! Runs in files of other programs: policies, motion, models.
//!
//! [`FORMATS`] is the list of what there is, a file each. A format turns a [`TrainedRun`] into the bytes of
//! one file.

mod bvh;
pub mod character;
pub mod episode;
mod format;
pub mod gltf;
mod mjcf;
mod onnx;
mod policy;
mod safetensors;

pub use format::{Excerpt, ExportFormat, TrainedRun};

use crate::train::task::Unsupported;
use anyhow::Result;

/// Every format there is.
pub static FORMATS: [ExportFormat; 5] = [
    onnx::FORMAT,
    safetensors::FORMAT,
    bvh::FORMAT,
    gltf::FORMAT,
    mjcf::FORMAT,
];

/// The bytes of a file in a format of [`FORMATS`].
///
/// # Errors
/// The format cannot carry runs of that kind: [`Unsupported`], which says the ones that can; or the motion
/// cannot be played.
pub fn export(run: &TrainedRun, format: &ExportFormat) -> Result<Vec<u8>> {
    if (format.carries)(run) {
        return (format.write)(run);
    }
    let able = FORMATS.iter().filter(|other| (other.carries)(run));
    let able: Vec<&str> = able.map(|other| other.name).collect();
    let why = format!(
        "`{}` is for {}, which a run of `{}` is not: it can be exported as {}",
        format.name,
        format.carried,
        run.config.task.name,
        able.join(", ")
    );
    Err(Unsupported(why).into())
}
