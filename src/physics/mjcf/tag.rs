//! An element of XML as it is written.

use crate::physics::kinematics::store;
use crate::physics::model::SolverParams;
use glam::{Quat, Vec3};
use std::fmt::{self, Write};

/// Smaller numbers have an exponent: they would be rows of zeros.
const LONG: f32 = 1e-5;

/// The name of an element, and its attributes.
pub struct Tag(String);

impl Tag {
    pub fn new(name: &str) -> Tag {
        Tag(name.to_string())
    }

    pub fn word(mut self, name: &str, value: &str) -> Tag {
        let value = value.replace('&', "&amp;").replace('<', "&lt;");
        let _ = write!(self.0, " {name}=\"{}\"", value.replace('"', "&quot;"));
        self
    }

    /// A name, unless there is none.
    pub fn name(self, name: &str) -> Tag {
        match name {
            "" => self,
            _ => self.word("name", name),
        }
    }

    pub fn numbers(self, name: &str, values: &[f32]) -> Tag {
        let number = |value: &f32| match *value != 0.0 && value.abs() < LONG {
            true => format!("{value:e}"),
            false => value.to_string(),
        };
        let numbers: Vec<String> = values.iter().map(number).collect();
        self.word(name, &numbers.join(" "))
    }

    /// Numbers, unless they are what the attribute is without being given.
    pub fn unless(self, usual: &[f32], name: &str, values: &[f32]) -> Tag {
        match values == usual {
            true => self,
            false => self.numbers(name, values),
        }
    }

    pub fn place(self, position: Vec3, rotation: Quat) -> Tag {
        let mut quat = [0.0; 4];
        store(&mut quat, rotation);
        let tag = self.unless(&[0.0; 3], "pos", &position.to_array());
        tag.unless(&[1.0, 0.0, 0.0, 0.0], "quat", &quat)
    }

    pub fn solver_params(self, solref: &str, solimp: &str, params: &SolverParams) -> Tag {
        let usual = SolverParams::default();
        let tag = self.unless(&usual.solref, solref, &params.solref);
        tag.unless(&usual.solimp, solimp, &params.solimp)
    }
}

impl fmt::Display for Tag {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        out.write_str(&self.0)
    }
}
