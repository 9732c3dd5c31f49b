//! Exported policies: evaluated elsewhere they come to what our own pass does, and what is said of them is enough
//! to run them. Exported motion and models: other readers find in them what was written.
//!
//! The tests need Python with NumPy and ONNX Runtime (`tests/reference/requirements.txt`), in the interpreter that
//! `PYTHON` names, else `python3`; `tests/run` sees to it.
#![cfg(feature = "export")]

#[path = "../support/low_level.rs"]
mod low_level;
#[path = "../support/python.rs"]
mod python;

mod bvh;
mod cases;
mod described;
mod gltf;
mod mjcf;
mod motion;
mod onnxruntime;
mod safetensors;
