//! A joint, and the spring and damper that its element may have.

use super::element::Element;
use super::error::Checked;
use super::frame::{Frame, unit};
use super::geom::solver_params;
use super::grammar::{FREE_JOINT, JOINT};
use super::member::Member;
use super::settings::MjcfSettings;
use crate::physics::model::{Joint, JointKind, SolverParams};
use glam::{DVec3, Vec3};

/// A joint whose index in the model is not known yet.
pub struct Jointed<'a> {
    pub element: Element<'a>,
    pub joint: Joint,
    pub armature: f32,
    /// Stiffness, Nm/rad, and damping, Nm s/rad.
    pub gains: [f32; 2],
    /// Whether those are a spring and a damper, and not the gains of a drive.
    pub sprung: bool,
    /// Where the spring rests, rad.
    pub rest: f32,
    /// Largest torque of its actuators, Nm.
    pub limit: f64,
}

/// Reads a `freejoint`, to which no default applies, or a `joint`, with its defaults.
pub fn read<'a>(element: Element<'a>, place: &Member<'a>, settings: &MjcfSettings) -> Jointed<'a> {
    if element.tag() == "freejoint" {
        element.check(&FREE_JOINT);
        return of_kind(element, JointKind::Free);
    }
    element.check(&JOINT);
    let kinds = [JointKind::Hinge, JointKind::Ball, JointKind::Free];
    let choice = element.keep(element.choice("type", &["hinge", "ball", "free"]));
    let mut read = of_kind(element.clone(), kinds[choice.flatten().unwrap_or(0)]);
    let number = |name| element.keep(not_negative(&element, name)).unwrap_or(0.0);
    read.armature = number("armature");
    read.gains = [number("stiffness"), number("damping")];
    if read.joint.kind != JointKind::Free {
        element.keep(shape(&mut read, place, settings));
    } else if read.gains[0] > 0.0 {
        let problem = "a free joint has no stiffness here; remove it";
        element.report(element.wrong("stiffness", problem));
    }
    read
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
        sprung: true,
        rest: 0.0,
        limit: f64::from(f32::MAX),
        element,
    }
}

/// What a joint has that is not free.
fn shape(read: &mut Jointed, place: &Member, settings: &MjcfSettings) -> Checked<()> {
    let (element, joint) = (&read.element, &mut read.joint);
    let at = |position| {
        place.place(Frame {
            position,
            ..Frame::default()
        })
    };
    let anchor = at(DVec3::from_array(
        element.numbers("pos")?.unwrap_or_default(),
    ));
    joint.position = anchor.position.as_vec3();
    if joint.kind == JointKind::Hinge {
        let axis = element.numbers("axis")?.unwrap_or([0.0, 0.0, 1.0]);
        let axis = unit(element, "axis", DVec3::from_array(axis))?;
        joint.axis = place.turned(axis).as_vec3();
        read.rest = (element.number("springref")?.unwrap_or(0.0) * settings.angle) as f32;
        read.limit = settings.bound(element, "actuatorfrcrange", "actuatorfrclimited")?;
    }
    joint.solver_params = solver_params(element, "solreflimit", "solimplimit")?;
    let Some([low, high]) = settings.limits(element, "range", "limited")? else {
        return Ok(());
    };
    if joint.kind == JointKind::Ball && low != 0.0 {
        return Err(element.wrong("range", "that of a ball joint is 0 and its largest angle"));
    }
    // Before its end a limit acts as one that ends there.
    let margin = f64::from(not_negative(element, "margin")?);
    let [low, high] = [low, high].map(|angle| angle * settings.angle);
    let range = match joint.kind {
        JointKind::Ball => [low, high - margin],
        _ => [low + margin, high - margin],
    };
    if range[0] > range[1] {
        return Err(element.wrong("margin", "nothing is left of the range"));
    }
    joint.range = Some(range.map(|angle| angle as f32));
    Ok(())
}

fn not_negative(element: &Element, name: &str) -> Checked<f32> {
    let number = element.overlay(name, [0.0])?[0];
    match number >= 0.0 {
        true => Ok(number as f32),
        false => Err(element.wrong(name, "it must not be negative")),
    }
}
