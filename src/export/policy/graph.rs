//! Computations as graphs of ONNX operators, of rows of numbers.

use std::ops::Range;

/// A computation of a batch of rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Graph {
    /// What is given, in order.
    pub inputs: Vec<GraphPort>,
    /// What comes out.
    pub outputs: Vec<GraphPort>,
    /// In the order in which they can be computed.
    pub nodes: Vec<GraphNode>,
    /// What has been learned.
    pub parameters: Vec<NamedTensor>,
    /// Whole numbers that operators need, each a list of one.
    pub indices: Vec<(String, i64)>,
    /// Other numbers that operators need, each a scalar.
    pub scalars: Vec<(String, f32)>,
}

/// An input or output.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GraphPort {
    /// Its name.
    pub name: String,
    /// Its shape behind the batch.
    pub shape: Vec<usize>,
}

/// One operator.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GraphNode {
    /// ONNX's name of it.
    pub op: &'static str,
    /// Names of its inputs.
    pub inputs: Vec<String>,
    /// The name of its output.
    pub output: String,
    /// Its attributes.
    pub attributes: Vec<(&'static str, Attribute)>,
}

/// The value of an operator's attribute.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Attribute {
    /// One number.
    Int(i64),
    /// A list of them.
    Ints(Vec<i64>),
}

/// Numbers by name.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedTensor {
    /// Its name.
    pub name: String,
    /// Its shape.
    pub shape: Vec<usize>,
    /// Row by row.
    pub values: Vec<f32>,
}

impl Graph {
    /// Adds an input. Returns its name.
    pub fn input(&mut self, name: &str, shape: &[usize]) -> String {
        self.inputs.push(port(name, shape));
        name.to_string()
    }

    /// Makes a value an output under another name.
    pub fn output(&mut self, name: &str, shape: &[usize], value: &str) {
        self.nodes.push(GraphNode {
            op: "Identity",
            inputs: vec![value.to_string()],
            output: name.to_string(),
            attributes: Vec::new(),
        });
        self.outputs.push(port(name, shape));
    }

    /// Adds numbers that have been learned. Returns their name.
    pub fn parameter(&mut self, name: String, shape: &[usize], values: Vec<f32>) -> String {
        debug_assert_eq!(shape.iter().product::<usize>(), values.len(), "{name}");
        self.parameters.push(NamedTensor {
            name: name.clone(),
            shape: shape.to_vec(),
            values,
        });
        name
    }

    /// Adds an operator. Returns the name of its output.
    pub fn node(&mut self, op: &'static str, inputs: &[&str]) -> String {
        self.node_with(op, inputs, Vec::new())
    }

    /// Adds an operator with attributes. Returns the name of its output.
    pub fn node_with(
        &mut self,
        op: &'static str,
        inputs: &[&str],
        attributes: Vec<(&'static str, Attribute)>,
    ) -> String {
        let output = format!("{}_{}", op.to_lowercase(), self.nodes.len());
        self.nodes.push(GraphNode {
            op,
            inputs: inputs.iter().map(|input| input.to_string()).collect(),
            output: output.clone(),
            attributes,
        });
        output
    }

    /// Limits a value.
    pub fn clip(&mut self, value: &str, limit: f32) -> String {
        let [low, high] = [-limit, limit].map(|bound| self.scalar(bound));
        self.node("Clip", &[value, &low, &high])
    }

    /// Joins rows.
    pub fn concat(&mut self, values: &[&str]) -> String {
        self.node_with("Concat", values, vec![("axis", Attribute::Int(1))])
    }

    /// Some columns of rows.
    pub fn columns(&mut self, value: &str, columns: Range<usize>) -> String {
        let bounds = [columns.start, columns.end].map(|bound| self.index(bound as i64));
        let axis = self.index(1);
        self.node("Slice", &[value, &bounds[0], &bounds[1], &axis])
    }

    /// A scalar. Returns its name.
    pub fn scalar(&mut self, value: f32) -> String {
        let same = self.scalars.iter().find(|(_, other)| *other == value);
        if let Some((name, _)) = same {
            return name.clone();
        }
        let name = format!("scalar_{}", self.scalars.len());
        self.scalars.push((name.clone(), value));
        name
    }

    fn index(&mut self, value: i64) -> String {
        let same = self.indices.iter().find(|(_, other)| *other == value);
        if let Some((name, _)) = same {
            return name.clone();
        }
        let name = format!("index_{}", self.indices.len());
        self.indices.push((name.clone(), value));
        name
    }
}

impl NamedTensor {
    /// The numbers as files have them.
    pub fn bytes(&self) -> Vec<u8> {
        let words = self.values.iter().flat_map(|value| value.to_le_bytes());
        words.collect()
    }
}

fn port(name: &str, shape: &[usize]) -> GraphPort {
    GraphPort {
        name: name.to_string(),
        shape: shape.to_vec(),
    }
}
