//! Reads models from MJCF, MuJoCo's file format.
//!
//! Bodies with free, ball and hinge joints; planes, spheres, capsules and boxes; default classes;
//! drives to a position; excluded contacts. All this means what it means to MuJoCo, but for `motor`
//! (see [`drive`]). The simulator has its own time step and solver, so that those of the file do not
//! count. What cannot change the dynamics is skipped, and everything else refused.

mod class;
mod drive;
mod element;
mod error;
mod exclude;
mod frame;
mod geom;
mod grammar;
mod joint;
mod mass;
mod settings;
mod shape;
mod worldbody;

use super::model::Model;
use class::Classes;
use element::Element;
pub use error::{MjcfError, Result};
pub use exclude::ordered;
use grammar::MUJOCO;
use roxmltree::Document;
use settings::MjcfSettings;
use std::io::Read;
use std::path::Path;
use worldbody::WorldBuilder;

/// Size of the largest file that is read, bytes: 1 MiB.
pub const MAX_BYTES: u64 = 1 << 20;

/// Reads a model from an MJCF file.
///
/// # Errors
/// A file that cannot be read, is larger than [`MAX_BYTES`] or is not UTF-8; text that is no valid XML;
/// elements, attributes and values that are wrong or not supported, with the line they are on.
pub fn read(path: &Path) -> Result<Model> {
    let failed = |error| MjcfError::Read {
        path: path.to_path_buf(),
        error,
    };
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path).map_err(failed)?;
    // One more than allowed: enough to be refused.
    let mut file = file.take(MAX_BYTES + 1);
    file.read_to_end(&mut bytes).map_err(failed)?;
    refuse_large(bytes.len(), path)?;
    let text = String::from_utf8(bytes).map_err(|error| {
        let good = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        MjcfError::Mjcf {
            path: path.to_path_buf(),
            line: 1 + good.iter().filter(|byte| **byte == b'\n').count() as u32,
            problem: "bytes that are not UTF-8; save the file as UTF-8".to_string(),
        }
    })?;
    parse(&text, path)
}

fn refuse_large(bytes: usize, path: &Path) -> Result<()> {
    match bytes as u64 <= MAX_BYTES {
        true => Ok(()),
        false => Err(MjcfError::TooLarge {
            path: path.to_path_buf(),
            limit: MAX_BYTES,
        }),
    }
}

/// Reads a model from MJCF text. `file` is what errors call it.
///
/// # Errors
/// Text that is wrong in one of the ways that [`read`] names.
///
/// ```
/// use footwork::physics::mjcf::parse;
/// use std::path::Path;
///
/// let text = r#"<mujoco><worldbody>
///   <body pos="0 0 1"><joint type="hinge" axis="0 1 0"/><geom type="capsule" size=".05 .2"/></body>
/// </worldbody></mujoco>"#;
/// let model = parse(text, Path::new("pendulum.xml"))?;
/// assert_eq!((model.bodies.len(), model.nv(), model.nu()), (1, 1, 0));
///
/// let error = parse("<mujoco><wordlbody/></mujoco>", Path::new("typo.xml")).unwrap_err();
/// assert!(error.to_string().contains("typo.xml"));
/// # Ok::<(), footwork::physics::mjcf::MjcfError>(())
/// ```
pub fn parse(text: &str, file: &Path) -> Result<Model> {
    refuse_large(text.len(), file)?;
    let document = Document::parse(text).map_err(|error| MjcfError::Mjcf {
        path: file.to_path_buf(),
        line: error.pos().row,
        problem: format!("this is no valid XML: {error}"),
    })?;
    let root = Element::new(file, document.root_element());
    if root.tag() != "mujoco" {
        return Err(root.error("is not what MJCF begins with: <mujoco>"));
    }
    root.check(&MUJOCO)?;
    let settings = MjcfSettings::read(&root)?;
    let classes = Classes::read(&root)?;
    let mut world = WorldBuilder::read(&root, &settings, &classes)?;
    world.drives(&root)?;
    world.pairs(&root)?;
    let mut model = world.model;
    model.name = root.word("model").unwrap_or_default().to_string();
    model.set_invweight0();
    Ok(model)
}
