//! The only place that knows wgpu, cubecl and burn's inside.
//!
//! - [`device`]: which adapter or processor runs the program;
//! - [`shader`]: the validated text and layout of every shader;
//! - [`kernel`]: the only launch;
//! - [`buffer`]: arrays on the device; [`array`]: the same, or in host memory;
//! - [`tensor`]: the only bridge between buffers and burn's tensors.

pub mod array;
pub mod buffer;
pub mod device;
pub mod kernel;
pub mod shader;
pub mod tensor;

pub use array::Array;
pub use buffer::{Buffer, Shared};
pub use device::{Choice, Device, Gpu};
