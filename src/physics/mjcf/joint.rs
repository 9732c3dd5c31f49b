//! A joint, and the spring and damper that its element may have.

use super::element::Element;
use super::error::Result;
use super::frame::unit;
use super::geom::solver_params;
use super::grammar::{FREE_JOINT, JOINT};
use super::settings::MjcfSettings;
use crate::physics::model::{Joint, JointKind, SolverParams};
use glam::{DVec3, Vec3};

/// A joint whose index in the model is not known yet.
pub struct Jointed<'a> {
    pub element: Element<'a>,
    pub joint: Joint,
    pub armature: f32,
    /// Stiffness, Nm/rad, and damping, Nm s/rad: by Isaac Gym's reading the gains of a drive.
    pub gains: [f32; 2],
}

/// Reads a `freejoint`, to which no default applies, or a `joint`.
pub fn read<'a>(element: Element<'a>, settings: &MjcfSettings) -> Result<Jointed<'a>> {
    if element.tag() == "freejoint" {
        element.check(&FREE_JOINT)?;
        return Ok(of_kind(element, JointKind::Free));
    }
    element.check(&JOINT)?;
    let kinds = [JointKind::Hinge, JointKind::Ball, JointKind::Free];
    let choice = element.choice("type", &["hinge", "ball", "free"])?;
    let mut read = of_kind(element, kinds[choice.unwrap_or(0)]);
    read.armature = not_negative(&read.element, "armature")?;
    read.gains = [
        not_negative(&read.element, "stiffness")?,
        not_negative(&read.element, "damping")?,
    ];
    if read.joint.kind != JointKind::Free {
        shape(&mut read, settings)?;
    }
    Ok(read)
}

fn of_kind(element: Element, kind: JointKind) -> Jointed {
    Jointed {
        joint: Joint {
            name: element.name().to_string(),
            kind,
            body: 0,
            position: Vec3::ZERO,
            axis: Vec3::Z,
            range: None,
            solver_params: SolverParams::default(),
            q: 0,
            v: 0,
        },
        armature: 0.0,
        gains: [0.0; 2],
        element,
    }
}

/// What a joint has that is not free.
fn shape(read: &mut Jointed, settings: &MjcfSettings) -> Result<()> {
    let (element, joint) = (&read.element, &mut read.joint);
    joint.position = DVec3::from_array(element.numbers("pos")?.unwrap_or_default()).as_vec3();
    if joint.kind == JointKind::Hinge {
        let axis = element.numbers("axis")?.unwrap_or([0.0, 0.0, 1.0]);
        joint.axis = unit(element, "axis", DVec3::from_array(axis))?.as_vec3();
    }
    joint.solver_params = solver_params(element, "solreflimit", "solimplimit")?;
    let Some(range) = settings.limits(element, "range", "limited")? else {
        return Ok(());
    };
    if joint.kind == JointKind::Ball && range[0] != 0.0 {
        return Err(element.wrong("range", "that of a ball joint is 0 and its largest angle"));
    }
    joint.range = Some(range.map(|angle| (angle * settings.angle) as f32));
    Ok(())
}

fn not_negative(element: &Element, name: &str) -> Result<f32> {
    let number = element.overlay(name, [0.0])?[0];
    match number >= 0.0 {
        true => Ok(number as f32),
        false => Err(element.wrong(name, "it must not be negative")),
    }
}
