//! Models from files: what MuJoCo makes of the same files (`tests/reference/model.py`), what is refused,
//! and several models in one world.

mod assembled;
mod compiled;
mod refused;

use footwork::physics::mjcf;
use footwork::physics::model::Model;
use std::path::Path;

/// A model of this text, called `m.xml`.
fn parse(text: &str) -> mjcf::Result<Model> {
    mjcf::parse(text, Path::new("m.xml"))
}
