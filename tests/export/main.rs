//! Exported policies: evaluated elsewhere they come to what our own pass does, and what is said of them is enough
//! to run them.
//!
//! The tests need Python with NumPy and ONNX Runtime (`tests/reference/requirements.txt`), in the interpreter that
//! `PYTHON` names, else `python3`; `tests/run` sees to it.
#![cfg(feature = "export")]

#[path = "../support/low_level.rs"]
mod low_level;
#[path = "../support/python.rs"]
mod python;

mod cases;
mod described;
mod onnxruntime;
mod safetensors;
