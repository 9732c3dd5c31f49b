//! Mass, its centre and its inertia, of geoms and of several together. In double precision: sums of
//! small and large parts lose too much otherwise.

use super::element::Element;
use super::error::Checked;
use super::frame::{Frame, orientation};
use super::settings::MjcfSettings;
use super::shape::GeomShape64;
use glam::{DMat3, DVec3};
use std::f64::consts::PI;

/// Less than this does not move as a body should: MuJoCo's bound on mass and moments of inertia.
const LEAST: f64 = 1e-15;

#[derive(Clone, Copy)]
pub struct Mass {
    /// kg
    pub mass: f64,
    pub com: DVec3,
    /// About the centre, kg m^2.
    pub inertia: DMat3,
}

impl Default for Mass {
    /// Nothing. The default of a matrix would be the identity.
    fn default() -> Mass {
        Mass {
            mass: 0.0,
            com: DVec3::ZERO,
            inertia: DMat3::ZERO,
        }
    }
}

impl Mass {
    /// The mass of a solid geom, in its own frame.
    pub fn solid(shape: &GeomShape64, mass: f64) -> Mass {
        let moments = match *shape {
            GeomShape64::Plane => DVec3::ZERO,
            GeomShape64::Sphere { radius } => DVec3::splat(0.4 * radius * radius),
            GeomShape64::Capsule { radius, half } => capsule(radius, half),
            GeomShape64::Box { half } => {
                let squares = half * half;
                (DVec3::splat(squares.element_sum()) - squares) / 3.0
            }
            GeomShape64::Cylinder { radius, half } => {
                let across = radius * radius / 4.0 + half * half / 3.0;
                DVec3::new(across, across, 0.5 * radius * radius)
            }
            GeomShape64::Ellipsoid { half } => {
                let squares = half * half;
                (DVec3::splat(squares.element_sum()) - squares) / 5.0
            }
        };
        Mass {
            mass,
            com: DVec3::ZERO,
            inertia: DMat3::from_diagonal(mass * moments),
        }
    }

    /// The mass as seen from around the frame it is in.
    pub fn seen_from(self, frame: &Frame) -> Mass {
        let rotation = DMat3::from_quat(frame.rotation);
        Mass {
            mass: self.mass,
            com: frame.position + frame.rotation * self.com,
            inertia: rotation * self.inertia * rotation.transpose(),
        }
    }

    pub fn sum(parts: &[Mass]) -> Mass {
        let mass: f64 = parts.iter().map(|part| part.mass).sum();
        if mass == 0.0 {
            return Mass::default();
        }
        let weighted = parts.iter().map(|part| part.mass * part.com);
        let com = weighted.sum::<DVec3>() / mass;
        let inertia = parts.iter().fold(DMat3::ZERO, |sum, part| {
            sum + part.inertia + part.mass * displaced(part.com - com)
        });
        Mass { mass, com, inertia }
    }

    /// What the element `inertial` says.
    pub fn read(element: &Element, settings: &MjcfSettings) -> Checked<Mass> {
        let frame = Frame::read(element, settings)?;
        if element.word("pos").is_none() {
            return Err(element.error("needs pos, the centre of mass"));
        }
        let mass = match element.number("mass")? {
            Some(mass) if mass >= 0.0 => mass,
            Some(_) => return Err(element.wrong("mass", "it must not be negative")),
            None => return Err(element.error("needs a mass")),
        };
        let about = Mass {
            mass,
            com: DVec3::ZERO,
            inertia: moments(element, settings)?,
        };
        Ok(about.seen_from(&frame))
    }

    pub fn can_move(&self) -> bool {
        self.mass > LEAST && least_moment(&self.inertia) > LEAST
    }
}

/// Moments of inertia per mass.
fn capsule(radius: f64, half: f64) -> DVec3 {
    let square = radius * radius;
    let (cylinder, sphere) = (2.0 * half, 4.0 / 3.0 * radius);
    let part = cylinder / (cylinder + sphere);
    // The halves of the sphere, moved apart to the ends.
    let ends = 0.4 * square + half * half + 0.75 * half * radius;
    let across = part * (square / 4.0 + half * half / 3.0) + (1.0 - part) * ends;
    let along = part * square / 2.0 + (1.0 - part) * 0.4 * square;
    DVec3::new(across, across, along)
}

/// Inertia of a unit mass at a point.
fn displaced(at: DVec3) -> DMat3 {
    let outer = DMat3::from_cols(at * at.x, at * at.y, at * at.z);
    DMat3::IDENTITY * at.length_squared() - outer
}

/// The inertia about the centre of mass, in the frame that is given with it.
fn moments(element: &Element, settings: &MjcfSettings) -> Checked<DMat3> {
    let diagonal = element.numbers::<3>("diaginertia")?;
    let full = element.numbers::<6>("fullinertia")?;
    let (name, inertia) = match (diagonal, full) {
        (Some(moments), None) => (
            "diaginertia",
            DMat3::from_diagonal(DVec3::from_array(moments)),
        ),
        (None, Some([xx, yy, zz, xy, xz, yz])) => {
            if orientation(element, settings)?.is_some() {
                return Err(element.wrong(
                    "fullinertia",
                    "it says how the inertia lies; remove the orientation",
                ));
            }
            let inertia = DMat3::from_cols_array(&[xx, xy, xz, xy, yy, yz, xz, yz, zz]);
            ("fullinertia", inertia)
        }
        _ => return Err(element.error("needs either diaginertia or fullinertia")),
    };
    match possible(&inertia) {
        true => Ok(inertia),
        false => Err(element.wrong(
            name,
            "no body has such moments: each must be positive, and none larger than the sum of the other two",
        )),
    }
}

/// Whether the mass that this comes from is nowhere negative.
fn possible(inertia: &DMat3) -> bool {
    let trace = trace(inertia);
    let spread = DMat3::IDENTITY * (0.5 * trace) - *inertia;
    trace >= 0.0 && least_moment(&spread) >= -1e-9 * trace
}

/// Smallest eigenvalue of a symmetric matrix, by the cosine of three times an angle.
fn least_moment(matrix: &DMat3) -> f64 {
    let mean = trace(matrix) / 3.0;
    let rest = *matrix - DMat3::IDENTITY * mean;
    let squares = rest.to_cols_array().map(|entry| entry * entry);
    let size = (squares.iter().sum::<f64>() / 6.0).sqrt();
    if size == 0.0 {
        return mean;
    }
    let cosine = 0.5 * (rest * (1.0 / size)).determinant();
    let angle = (cosine.clamp(-1.0, 1.0).acos() + 2.0 * PI) / 3.0;
    mean + 2.0 * size * angle.cos()
}

fn trace(matrix: &DMat3) -> f64 {
    matrix.x_axis.x + matrix.y_axis.y + matrix.z_axis.z
}
