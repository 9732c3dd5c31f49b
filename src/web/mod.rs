//! A run in a browser: the files of its page, and what plays them there.
//!
//! [`folder`] writes a static folder: the page, this crate as WebAssembly, and the run, quantised and in parts.
//! [`Page`] is what the WebAssembly plays, of motion matching ([`locomotion_run`]) or of a simulated body
//! ([`body_run`]); the page draws its scenes, and may search on a GPU. It needs no browser: tests play it here.

pub mod body_run;
pub mod folder;
pub mod locomotion_run;
pub mod motion_parts;
pub mod page;
pub mod played_run;
pub mod quantise;
pub mod run_file;

pub use page::Page;
pub use run_file::RunFile;
