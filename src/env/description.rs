//! What the numbers of observations and actions mean, for programs that know nothing else of them.

use serde::Serialize;

/// Numbers side by side in an observation or an action, of one kind.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct VectorPart {
    /// Unique in its observation or action.
    pub name: String,
    /// What each number is, in order.
    pub elements: Vec<String>,
    /// Unit of the quantity; `1` if it has none.
    pub unit: &'static str,
    /// Frame of reference of its components; `none` if it has none.
    pub frame: &'static str,
    /// The quantity in words.
    pub meaning: String,
    /// The number is the quantity less this, of each element, times `scale`. Empty: 0.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mean: Vec<f32>,
    /// See `mean`. Empty: 1.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub scale: Vec<f32>,
}

/// Names of a vector's components.
pub const XYZ: [&str; 3] = ["x", "y", "z"];
/// Names of the components of a vector on the ground where z is up.
pub const XY: [&str; 2] = ["x", "y"];
/// Names of the numbers of a rotation: where it takes the axes x and z.
pub const TWO_AXES: [&str; 6] = [
    "x_axis.x", "x_axis.y", "x_axis.z", "z_axis.x", "z_axis.y", "z_axis.z",
];

impl VectorPart {
    /// A quantity whose components have these names, as it is.
    pub fn new(
        name: impl Into<String>,
        elements: &[impl AsRef<str>],
        [unit, frame]: [&'static str; 2],
        meaning: impl Into<String>,
    ) -> Self {
        VectorPart {
            name: name.into(),
            elements: elements
                .iter()
                .map(|element| element.as_ref().to_string())
                .collect(),
            unit,
            frame,
            meaning: meaning.into(),
            mean: Vec::new(),
            scale: Vec::new(),
        }
    }

    /// This quantity times a factor.
    pub fn scaled(self, factor: f32) -> Self {
        VectorPart {
            scale: vec![factor; self.elements.len()],
            ..self
        }
    }
}

/// Numbers of all parts.
pub fn described_len(parts: &[VectorPart]) -> usize {
    parts.iter().map(|part| part.elements.len()).sum()
}
