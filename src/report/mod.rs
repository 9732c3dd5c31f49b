//! Output of a run for people: pictures, TensorBoard events and tables.
//!
//! The pictures share one look. [`png_file`] writes a PNG whole or not at all,
//! [`canvas`] draws smooth lines and text into one, [`chart`] adds the colours and
//! the axes, [`ground`] the view from above, and each of [`learning_curve`],
//! [`ablation`], [`trajectories`], [`obstacle_walks`], [`coverage`] and [`scaling`] is one figure.
//! None of them needs a display, a window system or an installed font.
//!
//! [`events`] writes what TensorBoard reads, and [`table`] what a terminal shows.

pub mod ablation;
pub mod canvas;
pub mod chart;
pub mod coverage;
mod error;
pub mod events;
pub mod font;
pub mod ground;
pub mod learning_curve;
pub mod obstacle_walks;
pub mod png_file;
pub mod scaling;
pub mod table;
pub mod trajectories;

pub use error::ReportError;
