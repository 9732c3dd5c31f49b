//! Output of a run for people: pictures, TensorBoard events and tables.
//!
//! The pictures share one look. [`png_file`] writes a PNG whole or not at all,
//! [`canvas`] draws smooth lines and text into one, [`chart`] adds the colours and
//! the axes, [`ground`] the view from above, and each of [`learning_curve`],
//! [`ablation`], [`trajectories`], [`obstacle_walks`], [`coverage`], [`scaling`] and [`win_rates`] is one
//! figure.
//! None of them needs a display, a window system or an installed font.
//!
//! [`events`] writes what TensorBoard reads, and [`table`] what a terminal shows. Only tables are there
//! without the feature `report`.

#[cfg(feature = "report")]
pub mod ablation;
#[cfg(feature = "report")]
pub mod canvas;
#[cfg(feature = "report")]
pub mod chart;
#[cfg(feature = "report")]
pub mod coverage;
#[cfg(feature = "report")]
mod error;
#[cfg(feature = "report")]
pub mod events;
#[cfg(feature = "report")]
pub mod font;
#[cfg(feature = "report")]
pub mod ground;
#[cfg(feature = "report")]
pub mod learning_curve;
#[cfg(feature = "report")]
pub mod obstacle_walks;
#[cfg(feature = "report")]
pub mod png_file;
#[cfg(feature = "report")]
pub mod scaling;
pub mod table;
#[cfg(feature = "report")]
pub mod trajectories;
#[cfg(feature = "report")]
pub mod win_rates;

#[cfg(feature = "report")]
pub use error::ReportError;
