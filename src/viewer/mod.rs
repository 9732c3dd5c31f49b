//! The windows: a controller at work, and why it does what it does; a simulated body, to be pushed; all
//! environments of a training.

pub mod app;
pub mod body_app;
pub mod bout_panel;
#[cfg(feature = "gamepad")]
pub mod gamepad;
pub mod maps;
pub mod pace;
pub mod policies;
pub mod pressed;
pub mod runners_up;
pub mod screen;
pub mod skills_panel;
pub mod source;
pub mod timeline;
pub mod transport;
pub mod watch;
pub mod watched_file;
pub mod window;

pub use app::Viewer;
pub use body_app::BodyViewer;
