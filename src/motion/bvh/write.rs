//! From a clip to a BVH file.

use crate::motion::clip::Clip;
use crate::motion::error::{MotionError, MotionResult};
use glam::{DQuat, EulerRot, Vec3};
use std::fmt::Write;
use std::path::Path;

/// File units a metre: the files are in centimetres, the commonest unit of BVH files.
const CENTIMETRES: f32 = 100.0;

/// Writes a clip as a BVH file in centimetres, whole or not at all. See [`to_text`].
pub fn write(path: &Path, clip: &Clip) -> MotionResult<()> {
    let text = to_text(clip)?;
    Ok(crate::container::write_whole(path, text.as_bytes())?)
}

/// The text of a BVH file in centimetres: six channels for the root and three for the others,
/// all ZYX; leaves without an end get an End Site of length zero, which many readers expect.
/// Joints come depth first, so a skeleton in another order is read back in that one.
///
/// Errors: numbers that are not finite, a rate of zero, names that BVH cannot hold.
pub fn to_text(clip: &Clip) -> MotionResult<String> {
    check(clip).map_err(|problem| MotionError::Unwritable {
        clip: clip.name.clone(),
        problem,
    })?;
    let mut text = String::from("HIERARCHY\n");
    let order = write_hierarchy(&mut text, clip);
    write_motion(&mut text, clip, &order);
    Ok(text)
}

fn check(clip: &Clip) -> Result<(), String> {
    let skeleton = &clip.skeleton;
    let bad_name = |name: &&String| {
        let plain: Vec<&str> = name.split_whitespace().collect();
        name.is_empty() || name.contains(['{', '}']) || plain.join(" ") != **name
    };
    if let Some(name) = skeleton.names.iter().find(bad_name) {
        return Err(format!(
            "the joint name {name:?} is empty or has braces, tabs or line ends; rename it"
        ));
    }
    let ends = skeleton.ends.iter().map(|end| &end.1);
    let mut points = clip.positions.iter().chain(&skeleton.offsets).chain(ends);
    if !points.all(|p| p.is_finite()) || !clip.rotations.iter().all(|r| r.is_finite()) {
        return Err("it has numbers that are not finite".to_string());
    }
    match clip.rate > 0.0 && clip.rate.is_finite() && clip.frames() > 0 {
        true => Ok(()),
        false => Err("it has no frames or no rate".to_string()),
    }
}

/// Writes the tree and gives the order of its joints. An explicit list of what is left to do
/// instead of a recursion, so that no chain of joints can exhaust the stack.
fn write_hierarchy(text: &mut String, clip: &Clip) -> Vec<usize> {
    enum Left {
        Open(usize),
        Close,
    }
    let skeleton = &clip.skeleton;
    let mut children = vec![Vec::new(); skeleton.joints()];
    for (joint, parent) in skeleton.parents.iter().enumerate() {
        if let Some(parent) = parent {
            children[*parent].push(joint);
        }
    }
    let mut ends = vec![Vec::new(); skeleton.joints()];
    for &(joint, end) in &skeleton.ends {
        ends[joint].push(end);
    }
    let mut order = Vec::with_capacity(skeleton.joints());
    let mut left = vec![Left::Open(0)];
    let mut indent = String::new();
    while let Some(next) = left.pop() {
        let Left::Open(joint) = next else {
            indent.pop();
            line(text, &indent, "}");
            continue;
        };
        let (kind, channels) = match joint {
            0 => (
                "ROOT",
                "6 Xposition Yposition Zposition Zrotation Yrotation Xrotation",
            ),
            _ => ("JOINT", "3 Zrotation Yrotation Xrotation"),
        };
        order.push(joint);
        line(text, &indent, &format!("{kind} {}", skeleton.names[joint]));
        line(text, &indent, "{");
        indent.push('\t');
        line(text, &indent, &offset(skeleton.offsets[joint]));
        line(text, &indent, &format!("CHANNELS {channels}"));
        if children[joint].is_empty() && ends[joint].is_empty() {
            ends[joint].push(Vec3::ZERO);
        }
        for &end in &ends[joint] {
            line(text, &indent, "End Site");
            line(text, &indent, "{");
            line(text, &indent, &format!("\t{}", offset(end)));
            line(text, &indent, "}");
        }
        left.push(Left::Close);
        left.extend(children[joint].iter().rev().map(|&child| Left::Open(child)));
    }
    order
}

fn line(text: &mut String, indent: &str, what: &str) {
    text.push_str(indent);
    text.push_str(what);
    text.push('\n');
}

fn offset(metres: Vec3) -> String {
    let o = metres * CENTIMETRES;
    format!("OFFSET {:.6} {:.6} {:.6}", o.x, o.y, o.z)
}

fn write_motion(text: &mut String, clip: &Clip, order: &[usize]) {
    // Writing to a String cannot fail, so the results are of no interest.
    let _ = writeln!(text, "MOTION\nFrames: {}", clip.frames());
    let _ = writeln!(text, "Frame Time: {:.9}", 1.0 / f64::from(clip.rate));
    for (frame, &position) in clip.positions.iter().enumerate() {
        let p = position * CENTIMETRES;
        let _ = write!(text, "{:.6} {:.6} {:.6}", p.x, p.y, p.z);
        let pose = clip.pose(frame);
        for &joint in order {
            // In f64: near an upright Y angle the other two are ill-conditioned.
            let rotation: DQuat = pose[joint].as_dquat().normalize();
            let (z, y, x) = rotation.to_euler(EulerRot::ZYX);
            let (z, y, x) = (z.to_degrees(), y.to_degrees(), x.to_degrees());
            let _ = write!(text, " {z:.6} {y:.6} {x:.6}");
        }
        text.push('\n');
    }
}
