//! Networks on a GPU: narrow dense ones by custom WGSL kernels ([`fused`]), others layer by layer in burn's
//! tensors ([`layerwise`]), without its autodiff.

mod dims;
pub(super) mod fused;
pub(super) mod layerwise;
pub(super) mod moments;
pub mod tensors;
