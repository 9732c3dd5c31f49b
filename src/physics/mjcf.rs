//! Reads models from MJCF, MuJoCo's file format, and writes them.
//!
//! Bodies with free, ball and hinge joints, their springs and dampers; planes, spheres, capsules and boxes,
//! and shapes that only weigh or are only seen; frames, included files, default classes; motors, drives to a
//! position and general actuators that are one of these; excluded contacts. All this means what it means to
//! MuJoCo, unless [`MjcfOptions`] say otherwise. The simulator has its own time step and solver, so that
//! those of the file do not count. What cannot change the dynamics is skipped, and everything else refused,
//! all of it at once.

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
mod member;
mod options;
mod settings;
mod shape;
mod source;
mod tag;
mod worldbody;
mod write;

use super::model::Model;
use class::Classes;
use element::Element;
pub use error::{MjcfError, MjcfProblem, Result};
pub use exclude::ordered;
use grammar::{MUJOCO, TENDON, TENDONS};
pub use options::MjcfOptions;
use settings::MjcfSettings;
pub use source::MAX_BYTES;
use source::{MjcfSource, read_text, refuse_large, xml};
use std::path::Path;
use worldbody::WorldBuilder;
pub use write::{UnwritableModel, to_text};

/// A model, and what the user should know of how it was read.
#[derive(Clone, Debug)]
pub struct MjcfModel {
    /// The model.
    pub model: Model,
    /// What to tell the user.
    pub notes: Vec<String>,
}

/// Reads a model from an MJCF file.
///
/// # Errors
/// A file, or one that it includes, that cannot be read, is larger than [`MAX_BYTES`] or is not UTF-8; text
/// that is no valid XML; elements, attributes and values that are wrong or not supported, all of them, with
/// the lines they are on.
pub fn read(path: &Path, options: MjcfOptions) -> Result<MjcfModel> {
    compile(&read_text(path)?, path, options)
}

/// Reads a model from MJCF text. `file` is what errors call it, and its folder is where included files are.
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
    compile(text, file, MjcfOptions::default()).map(|read| read.model)
}

fn compile(text: &str, file: &Path, options: MjcfOptions) -> Result<MjcfModel> {
    refuse_large(text.len(), file)?;
    let source = MjcfSource::new(text, file)?;
    let document = xml(&source.text, file)?;
    let root = Element::new(&source, document.root_element());
    if root.tag() != "mujoco" {
        root.report(root.error("is not what MJCF begins with: <mujoco>"));
        source.check()?;
    }
    root.check(&MUJOCO);
    let settings = MjcfSettings::read(&root, options);
    let classes = Classes::read(&root);
    let mut world = WorldBuilder::read(&root, &settings, &classes);
    let notes = world.drives(&root);
    world.pairs(&root);
    ties(&root, &classes, &settings);
    source.check()?;
    let mut model = world.model;
    model.name = root.word("model").unwrap_or_default().to_string();
    model.set_invweight0();
    Ok(MjcfModel { model, notes })
}

/// Refuses what ties bodies and joints together, unless it is switched off or does nothing.
fn ties<'a>(root: &Element<'a>, classes: &Classes<'a>, settings: &MjcfSettings) {
    for tie in root.sections("equality").flat_map(|top| top.children()) {
        let tie = classes.apply(tie, None);
        if tie.word("active") != Some("false") {
            let problem = r#"is not supported; remove it, or switch it off with active="false""#;
            tie.report(tie.error(problem));
        }
    }
    for tendon in root.within("tendon", &TENDONS) {
        let tendon = classes.apply(tendon, None);
        tendon.check(&TENDON);
        if let Some(Some(_)) = tendon.keep(settings.limits(&tendon, "range", "limited")) {
            let problem = r#"limited tendons are not supported; remove it, or set limited="false""#;
            tendon.report(tendon.wrong("range", problem));
        }
    }
}
