//! Networks: their form, their parameters, their evaluation and gradients.

pub mod adam;
pub mod autodiff;
pub mod cpu;
pub mod gpu;
pub mod layer;
pub mod network;
pub mod policy;
pub mod tensors;
