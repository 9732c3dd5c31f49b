//! Policies as safetensors files: the parameters of their graph, and what is said of it.

use super::format::{ExportFormat, TrainedRun};
use super::policy::graph::NamedTensor;
use super::policy::{ExportedPolicy, export_policy};
use anyhow::Result;
use safetensors::{Dtype, View, serialize};
use std::borrow::Cow;

/// The format in the list.
pub const FORMAT: ExportFormat = ExportFormat {
    name: "safetensors",
    about: "The policy's parameters by name, in PyTorch's shapes, with the same description",
    carries: |_| true,
    carried: "runs of every task",
    motion: false,
    write,
};

fn write(run: &TrainedRun) -> Result<Vec<u8>> {
    let ExportedPolicy { graph, description } = export_policy(run)?;
    let tensors = graph.parameters.iter().map(|tensor| (&tensor.name, tensor));
    let metadata = description.metadata()?.into_iter().collect();
    Ok(serialize(tensors, Some(metadata))?)
}

impl View for &NamedTensor {
    fn dtype(&self) -> Dtype {
        Dtype::F32
    }

    fn shape(&self) -> &[usize] {
        &self.shape
    }

    fn data(&self) -> Cow<'_, [u8]> {
        self.bytes().into()
    }

    fn data_len(&self) -> usize {
        4 * self.values.len()
    }
}
