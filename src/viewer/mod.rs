//! The window: a controller at work, and why it does what it does.

pub mod app;
#[cfg(feature = "gamepad")]
pub mod gamepad;
pub mod maps;
pub mod pace;
pub mod runners_up;
pub mod screen;
pub mod source;
pub mod timeline;
pub mod watch;
pub mod window;

pub use app::Viewer;
