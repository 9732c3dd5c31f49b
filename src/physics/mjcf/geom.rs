//! A geom: its shape, where it is, what it weighs, how it touches.

use super::element::Element;
use super::error::Checked;
use super::frame::{Frame, from_z};
use super::mass::Mass;
use super::member::Member;
use super::settings::MjcfSettings;
use super::shape::GeomShape64;
use crate::physics::model::{Geom, GeomShape, SolverParams};
use glam::DVec3;

const TYPES: [&str; 7] = [
    "plane",
    "sphere",
    "capsule",
    "box",
    "cylinder",
    "ellipsoid",
    "mesh",
];

/// kg/m^3
const DENSITY: f64 = 1000.0;

/// A geom in the frame of its element's body.
pub struct Solid {
    /// None if there is nothing that it could touch.
    pub touching: Option<(Geom, Frame, Bits)>,
    pub mass: Mass,
}

/// What a geom is (`contype`), and what it touches (`conaffinity`): a bit for each kind.
#[derive(Clone, Copy)]
pub struct Bits {
    kind: u32,
    touches: u32,
}

impl Bits {
    pub fn meet(self, other: Bits) -> bool {
        self.kind & other.touches != 0 || other.kind & self.touches != 0
    }

    /// Whether there could be anything that it touches.
    pub fn any(self) -> bool {
        self.kind != 0 || self.touches != 0
    }
}

/// Reads a geom with its defaults. What it weighs counts if `weighs`.
pub fn read(
    member: &Member,
    element: &Element,
    settings: &MjcfSettings,
    weighs: bool,
) -> Checked<Solid> {
    let bits = Bits {
        kind: bits(element, "contype")?,
        touches: bits(element, "conaffinity")?,
    };
    let kind = TYPES[element.choice("type", &TYPES)?.unwrap_or(1)];
    let mesh = kind == "mesh" || element.word("mesh").is_some();
    if mesh {
        return seen(element, weighs, bits);
    }
    let (shape, frame) = shape(element, kind, settings)?;
    let frame = member.place(frame);
    let mass = Mass::solid(&shape, mass(element, shape.volume())?).seen_from(&frame);
    if !bits.any() {
        let touching = None;
        return Ok(Solid { touching, mass });
    }
    let Some(narrowed) = shape.narrowed() else {
        let problem = "such a shape cannot touch here; use a capsule or a box, or have it touch nothing by contype=\"0\" conaffinity=\"0\"";
        return Err(element.wrong("type", problem));
    };
    let geom = touching(element, narrowed, &frame)?;
    Ok(Solid {
        touching: Some((geom, frame, bits)),
        mass,
    })
}

/// A mesh: its file is not read, so that it must neither touch nor weigh.
fn seen(element: &Element, weighs: bool, bits: Bits) -> Checked<Solid> {
    if bits.any() {
        let problem = "is a mesh that touches; put spheres, capsules or boxes in its place, and have it touch nothing by contype=\"0\" conaffinity=\"0\"";
        return Err(element.error(problem));
    }
    if weighs && mass(element, 1.0)? != 0.0 {
        let problem = "is a mesh that weighs, which is not supported; give it mass=\"0\", or its body <inertial>";
        return Err(element.error(problem));
    }
    Ok(Solid {
        touching: None,
        mass: Mass::default(),
    })
}

/// A geom on no body yet.
fn touching(element: &Element, shape: GeomShape, frame: &Frame) -> Checked<Geom> {
    let frictionless = match element.number("condim")?.unwrap_or(3.0) {
        1.0 => true,
        3.0 => false,
        _ => {
            let advice = "supported are 1 (no friction) and 3 (sliding friction)";
            return Err(element.wrong("condim", advice));
        }
    };
    let friction = element.overlay("friction", [1.0, 0.005, 0.0001])?[0];
    if friction < 0.0 {
        return Err(element.wrong("friction", "it must not be negative"));
    }
    Ok(Geom {
        name: element.name().to_string(),
        body: None,
        shape,
        position: frame.position.as_vec3(),
        rotation: frame.rotation.as_quat(),
        friction: friction as f32,
        frictionless,
        solver_params: solver_params(element, "solref", "solimp")?,
    })
}

fn shape(element: &Element, kind: &str, settings: &MjcfSettings) -> Checked<(GeomShape64, Frame)> {
    let mut size = element.overlay("size", [0.0; 3])?;
    let mut frame = Frame::read(element, settings)?;
    if let Some(ends) = element.numbers::<6>("fromto")? {
        let half;
        (frame, half) = between(element, ends, &frame)?;
        match kind {
            "capsule" | "cylinder" => size[1] = half,
            "box" | "ellipsoid" => size = [size[0], size[0], half],
            _ => return Err(element.wrong("fromto", "only capsules and boxes have two ends")),
        }
    }
    let used = match kind {
        "plane" => 0,
        "sphere" => 1,
        "capsule" | "cylinder" => 2,
        _ => 3,
    };
    if size[..used].iter().any(|size| *size as f32 <= 0.0) {
        let needs = format!("a {kind} has {used} positive numbers there");
        return Err(element.wrong("size", &needs));
    }
    let (radius, half) = (size[0], DVec3::from_array(size));
    let shape = match kind {
        "plane" => GeomShape64::Plane,
        "sphere" => GeomShape64::Sphere { radius },
        "capsule" => GeomShape64::Capsule {
            radius,
            half: half.y,
        },
        "cylinder" => GeomShape64::Cylinder {
            radius,
            half: half.y,
        },
        "ellipsoid" => GeomShape64::Ellipsoid { half },
        _ => GeomShape64::Box { half },
    };
    Ok((shape, frame))
}

/// The frame halfway between two ends, z pointing to the first, and half their distance.
fn between(element: &Element, ends: [f64; 6], frame: &Frame) -> Checked<(Frame, f64)> {
    if *frame != Frame::default() {
        return Err(element.wrong(
            "fromto",
            "it says where the geom is; remove pos and the orientation",
        ));
    }
    let [a, b] = [DVec3::from_slice(&ends[..3]), DVec3::from_slice(&ends[3..])];
    let half = 0.5 * (a - b).length();
    if half < 1e-9 {
        return Err(element.wrong("fromto", "the two ends are the same"));
    }
    let frame = Frame {
        position: 0.5 * (a + b),
        rotation: from_z((a - b).normalize()),
    };
    Ok((frame, half))
}

fn mass(element: &Element, volume: f64) -> Checked<f64> {
    let given = element.number("mass")?;
    let density = element.number("density")?.unwrap_or(DENSITY);
    let name = if given.is_some() { "mass" } else { "density" };
    let mass = given.unwrap_or(density * volume);
    match mass >= 0.0 {
        true => Ok(mass),
        false => Err(element.wrong(name, "it must not be negative")),
    }
}

fn bits(element: &Element, name: &str) -> Checked<u32> {
    let number = element.number(name)?.unwrap_or(1.0);
    match number >= 0.0 && number.fract() == 0.0 {
        true => Ok(number as u32),
        false => Err(element.wrong(name, "these are bits: a whole number that is not negative")),
    }
}

/// MuJoCo's two attributes of a constraint, of geoms and of limits.
pub fn solver_params(element: &Element, solref: &str, solimp: &str) -> Checked<SolverParams> {
    let usual = SolverParams::default();
    let springs = element.overlay(solref, usual.solref.map(f64::from))?;
    let springs = springs.map(|number| number as f32);
    if springs.iter().any(|number| *number <= 0.0) {
        let problem = "only a time constant and a damping ratio, both positive, are supported";
        return Err(element.wrong(solref, problem));
    }
    let impedances = element.overlay(solimp, usual.solimp.map(f64::from))?;
    let [least, most, width, middle, power] = impedances;
    let parts = [least, most, middle]
        .iter()
        .all(|part| (0.0..=1.0).contains(part));
    if !parts || width < 0.0 || power < 1.0 {
        let problem = "expected are two impedances from 0 to 1, a width, a midpoint from 0 to 1, and a power of at least 1";
        return Err(element.wrong(solimp, problem));
    }
    Ok(SolverParams {
        solref: springs,
        solimp: impedances.map(|number| number as f32),
    })
}
