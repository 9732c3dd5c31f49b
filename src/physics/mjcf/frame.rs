//! Where an element puts its frame: `pos`, and a rotation in one of five ways.

use super::element::Element;
use super::error::Checked;
use super::settings::MjcfSettings;
use glam::{DMat3, DQuat, DVec3};
use std::ops::Mul;

/// Shorter vectors point nowhere.
const SHORTEST: f64 = 1e-9;

/// Seen from the frame around it.
#[derive(Clone, Copy, Default, PartialEq)]
pub struct Frame {
    pub position: DVec3,
    pub rotation: DQuat,
}

impl Mul for Frame {
    type Output = Frame;
    fn mul(self, inner: Frame) -> Frame {
        Frame {
            position: self.position + self.rotation * inner.position,
            rotation: (self.rotation * inner.rotation).normalize(),
        }
    }
}

impl Frame {
    pub fn read(element: &Element, settings: &MjcfSettings) -> Checked<Frame> {
        let position = element.numbers("pos")?.unwrap_or_default();
        Ok(Frame {
            position: DVec3::from_array(position),
            rotation: orientation(element, settings)?.unwrap_or(DQuat::IDENTITY),
        })
    }
}

/// The rotation that is given, if one is: the element's own way replaces that of a class.
pub fn orientation(element: &Element, settings: &MjcfSettings) -> Checked<Option<DQuat>> {
    element.innermost(|layer| one_turn(layer, settings))
}

/// What one layer says.
fn one_turn(element: &Element, settings: &MjcfSettings) -> Checked<Option<DQuat>> {
    let ways = ["quat", "axisangle", "xyaxes", "zaxis", "euler"];
    let mut given = ways.into_iter().filter(|way| element.word(way).is_some());
    let way = given.next();
    if let Some(second) = given.next() {
        return Err(element.wrong(second, "the orientation is given twice; keep one"));
    }
    let Some(way) = way else { return Ok(None) };
    let rotation = match way {
        "quat" => quat(element),
        "axisangle" => axisangle(element, settings),
        "xyaxes" => xyaxes(element),
        "zaxis" => zaxis(element),
        _ => euler(element, settings),
    };
    rotation.map(Some)
}

fn quat(element: &Element) -> Checked<DQuat> {
    let [w, x, y, z] = element.numbers("quat")?.unwrap_or_default();
    let quat = DQuat::from_xyzw(x, y, z, w);
    match quat.length() > SHORTEST {
        true => Ok(quat.normalize()),
        false => Err(element.wrong("quat", "this quaternion is zero")),
    }
}

fn axisangle(element: &Element, settings: &MjcfSettings) -> Checked<DQuat> {
    let [x, y, z, angle] = element.numbers("axisangle")?.unwrap_or_default();
    let axis = unit(element, "axisangle", DVec3::new(x, y, z))?;
    Ok(DQuat::from_axis_angle(axis, angle * settings.angle))
}

fn xyaxes(element: &Element) -> Checked<DQuat> {
    let [a, b, c, d, e, f] = element.numbers("xyaxes")?.unwrap_or_default();
    let x = unit(element, "xyaxes", DVec3::new(a, b, c))?;
    let y = DVec3::new(d, e, f);
    let y = unit(element, "xyaxes", y - x * x.dot(y))?;
    let axes = DMat3::from_cols(x, y, x.cross(y));
    Ok(DQuat::from_mat3(&axes).normalize())
}

fn zaxis(element: &Element) -> Checked<DQuat> {
    let axis = element.numbers("zaxis")?.unwrap_or_default();
    let axis = unit(element, "zaxis", DVec3::from_array(axis))?;
    Ok(from_z(axis))
}

/// About x, then about the y and the z that this has turned.
fn euler(element: &Element, settings: &MjcfSettings) -> Checked<DQuat> {
    let angles = element.numbers::<3>("euler")?.unwrap_or_default();
    let [x, y, z] = angles.map(|angle| angle * settings.angle);
    let rotation =
        DQuat::from_rotation_x(x) * DQuat::from_rotation_y(y) * DQuat::from_rotation_z(z);
    Ok(rotation.normalize())
}

pub fn unit(element: &Element, attribute: &str, vector: DVec3) -> Checked<DVec3> {
    match vector.length() > SHORTEST {
        true => Ok(vector.normalize()),
        false => Err(element.wrong(attribute, "this points in no direction")),
    }
}

/// The smallest rotation that takes z to a unit vector.
pub fn from_z(to: DVec3) -> DQuat {
    let axis = DVec3::Z.cross(to);
    let (sine, cosine) = (axis.length(), to.z);
    let axis = if sine > SHORTEST {
        axis / sine
    } else {
        DVec3::X
    };
    DQuat::from_axis_angle(axis, sine.atan2(cosine))
}
