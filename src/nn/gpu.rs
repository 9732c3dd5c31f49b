//! Networks on a GPU: narrow dense ones by custom WGSL kernels ([`fused`]), others layer by layer in burn's
//! tensors ([`layerwise`]), without its autodiff; copies of one network with parameters of their own in one launch
//! ([`blockwise`]).

pub(super) mod blockwise;
mod dims;
pub(super) mod fused;
pub(super) mod layerwise;
pub(super) mod moments;
pub mod tensors;
