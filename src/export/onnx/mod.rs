//! Policies as ONNX files.

mod schema;

use super::format::{ExportFormat, TrainedRun};
use super::policy::graph::{Attribute, Graph, GraphNode, GraphPort, NamedTensor};
use super::policy::{ExportedPolicy, export_policy};
use crate::train::config::VERSION;
use anyhow::Result;
use prost::Message;
use schema::{
    AttributeMessage, Dimension, DimensionValue, FLOAT, GraphMessage, INT, INT64, INTS,
    ModelMessage, NodeMessage, OperatorSet, StringEntry, Tensor, TensorShape, TensorType,
    ValueInfo, ValueType,
};

/// The format in the list.
pub const FORMAT: ExportFormat = ExportFormat {
    name: "onnx",
    about: "The policy as a network for ONNX Runtime and engines, with all that is needed to run it",
    carries: |_| true,
    carried: "runs of every task",
    motion: false,
    write,
};

/// Version of the operators: the newest that engines read, too.
const OPERATORS: i64 = 13;
/// Version of the file format that came with them.
const IR_VERSION: i64 = 7;

fn write(run: &TrainedRun) -> Result<Vec<u8>> {
    let ExportedPolicy { graph, description } = export_policy(run)?;
    let entry = |(key, value)| StringEntry { key, value };
    let model = ModelMessage {
        ir_version: IR_VERSION,
        opset_import: vec![OperatorSet {
            domain: String::new(),
            version: OPERATORS,
        }],
        producer_name: "footwork".into(),
        producer_version: VERSION.into(),
        doc_string: description.about.clone(),
        graph: Some(message(&graph, &description.task)),
        metadata_props: description.metadata()?.into_iter().map(entry).collect(),
    };
    Ok(model.encode_to_vec())
}

fn message(graph: &Graph, name: &str) -> GraphMessage {
    let parameters = graph.parameters.iter().map(parameter);
    let scalars = graph.scalars.iter();
    let scalars = scalars.map(|(name, value)| tensor(name, FLOAT, &[], &value.to_le_bytes()));
    let indices = graph.indices.iter();
    let indices = indices.map(|(name, value)| tensor(name, INT64, &[1], &value.to_le_bytes()));
    GraphMessage {
        node: graph.nodes.iter().map(node).collect(),
        name: name.into(),
        initializer: parameters.chain(scalars).chain(indices).collect(),
        input: graph.inputs.iter().map(value_info).collect(),
        output: graph.outputs.iter().map(value_info).collect(),
    }
}

fn node(node: &GraphNode) -> NodeMessage {
    let attribute = |(name, value): &(&str, Attribute)| {
        let (kind, i, ints) = match value {
            Attribute::Int(value) => (INT, *value, Vec::new()),
            Attribute::Ints(values) => (INTS, 0, values.clone()),
        };
        AttributeMessage {
            name: name.to_string(),
            i,
            ints,
            kind,
        }
    };
    NodeMessage {
        input: node.inputs.clone(),
        output: vec![node.output.clone()],
        name: node.output.clone(),
        op_type: node.op.into(),
        attribute: node.attributes.iter().map(attribute).collect(),
    }
}

fn parameter(parameter: &NamedTensor) -> Tensor {
    let shape: Vec<i64> = parameter.shape.iter().map(|&size| size as i64).collect();
    tensor(&parameter.name, FLOAT, &shape, &parameter.bytes())
}

fn tensor(name: &str, data_type: i32, dims: &[i64], bytes: &[u8]) -> Tensor {
    Tensor {
        dims: dims.to_vec(),
        data_type,
        name: name.into(),
        raw_data: bytes.to_vec(),
    }
}

/// A port, whose first dimension is the batch's.
fn value_info(port: &GraphPort) -> ValueInfo {
    let batch = DimensionValue::Name("batch".into());
    let sizes = port
        .shape
        .iter()
        .map(|&size| DimensionValue::Value(size as i64));
    let dims = [batch].into_iter().chain(sizes);
    let shape = TensorShape {
        dim: dims.map(|value| Dimension { value: Some(value) }).collect(),
    };
    ValueInfo {
        name: port.name.clone(),
        kind: Some(ValueType {
            tensor_type: Some(TensorType {
                elem_type: FLOAT,
                shape: Some(shape),
            }),
        }),
    }
}
