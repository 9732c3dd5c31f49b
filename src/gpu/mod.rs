//! The only place that knows wgpu, cubecl and burn's inside.
//!
//! - [`device`]: which adapter or processor runs the program;
//! - [`mod@array`]: arrays of either;
//! - [`shader`]: the validated text and layout of every shader;
//! - `adapter`: a graphics adapter; `buffer`: arrays on it; `kernel`: the only launch; `tensor`: the
//!   only bridge between buffers and burn's tensors.
//!
//! Without the feature `gpu` there is no adapter, and no value of the types [`Gpu`] and [`Buffer`].

pub mod array;
pub mod device;
mod no_adapter;
pub mod shader;

#[cfg(feature = "gpu")]
mod adapter;
#[cfg(feature = "gpu")]
pub mod buffer;
#[cfg(feature = "gpu")]
pub mod kernel;
#[cfg(feature = "gpu")]
pub mod tensor;

#[cfg(not(feature = "gpu"))]
mod absent;

#[cfg(not(feature = "gpu"))]
pub use absent::{Argument, Buffer, Gpu, Shared};
#[cfg(feature = "gpu")]
pub use adapter::Gpu;
pub use array::Array;
#[cfg(feature = "gpu")]
pub use buffer::{Argument, Buffer, Shared};
pub use device::{Choice, Device};
pub use no_adapter::NoAdapter;
pub use shader::groups;
