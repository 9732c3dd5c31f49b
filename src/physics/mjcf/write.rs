//! From a model to the text of an MJCF file.

use super::tag::Tag;
use crate::physics::model::{Dof, Drive, Geom, GeomShape, Joint, JointKind, Model};
use crate::physics::simulator::{STEP_RATE, SUBSTEPS};
use std::collections::BTreeSet;
use std::fmt::Write;

/// Steps of MuJoCo in one of ours. It cuts torques to their limits before a step, where ours are implicit in the
/// motion: at our own step limbs would jerk.
const FINER: usize = 4;

/// A model of which MJCF cannot say what may touch what.
#[derive(Debug, thiserror::Error)]
#[error("some shapes of {first} and {second} may touch and others may not, which is not supported")]
pub struct UnwritableModel {
    first: String,
    second: String,
}

/// The text of an MJCF file that MuJoCo, and [`parse`](super::parse), read as this model: angles in radians, masses
/// as they were summed up, an actuator for each driven degree of freedom in the order of the controls.
///
/// An action lasts `substeps` steps, a number among the custom ones. The integrator is the one of MuJoCo's that damps
/// drives implicitly, as ours does, and the step so short that it moves as here. Bodies and joints without a name, where one is needed, are called
/// by their numbers.
///
/// # Errors
/// See [`UnwritableModel`].
pub fn to_text(model: &Model) -> Result<String, UnwritableModel> {
    let mut text = MjcfText {
        model,
        text: String::new(),
        depth: 0,
    };
    text.open(Tag::new("mujoco").word("model", &model.name));
    text.leaf(Tag::new("compiler").word("angle", "radian"));
    text.options();
    text.worldbody();
    text.contact()?;
    text.actuators();
    text.close("mujoco");
    Ok(text.text)
}

struct MjcfText<'a> {
    model: &'a Model,
    text: String,
    depth: usize,
}

impl MjcfText<'_> {
    fn line(&mut self, line: &str) {
        let indent = "  ".repeat(self.depth);
        let _ = writeln!(self.text, "{indent}{line}");
    }

    fn leaf(&mut self, tag: Tag) {
        self.line(&format!("<{tag}/>"));
    }

    fn open(&mut self, tag: Tag) {
        self.line(&format!("<{tag}>"));
        self.depth += 1;
    }

    fn close(&mut self, name: &str) {
        self.depth -= 1;
        self.line(&format!("</{name}>"));
    }

    fn options(&mut self) {
        let step = (1.0 / (f64::from(STEP_RATE) * FINER as f64)).to_string();
        // MuJoCo 4.0.0 factorises sparse matrices of such models wrongly (its issue 3767).
        let option = Tag::new("option").word("timestep", &step);
        let option = option.word("integrator", "implicitfast");
        self.leaf(option.word("jacobian", "dense"));
        self.open(Tag::new("custom"));
        let substeps = Tag::new("numeric").name("substeps");
        self.leaf(substeps.numbers("data", &[(FINER * SUBSTEPS) as f32]));
        self.close("custom");
    }

    fn worldbody(&mut self) {
        self.open(Tag::new("worldbody"));
        self.geoms(None);
        for tree in &self.model.trees {
            self.body(tree.bodies.start);
        }
        self.close("worldbody");
    }

    /// A body and all that hangs on it.
    fn body(&mut self, index: usize) {
        let body = &self.model.bodies[index];
        let name = self.body_name(Some(index));
        let tag = Tag::new("body").word("name", &name);
        self.open(tag.place(body.position, body.rotation));
        for joint in body.joints.clone() {
            self.joint(joint);
        }
        let [xx, xy, xz, _, yy, yz, _, _, zz] = body.inertia.to_cols_array();
        let inertial = Tag::new("inertial").numbers("pos", &body.com.to_array());
        let inertial = inertial.numbers("mass", &[body.mass]);
        self.leaf(inertial.numbers("fullinertia", &[xx, yy, zz, xy, xz, yz]));
        self.geoms(Some(index));
        let bodies = index + 1..self.model.bodies.len();
        for child in bodies.filter(|&child| self.model.bodies[child].parent == Some(index)) {
            self.body(child);
        }
        self.close("body");
    }

    fn joint(&mut self, index: usize) {
        let joint = &self.model.joints[index];
        let Dof {
            armature, spring, ..
        } = self.model.dofs[joint.v];
        let kind = match joint.kind {
            JointKind::Free => "free",
            JointKind::Ball => "ball",
            JointKind::Hinge => "hinge",
        };
        let mut tag = Tag::new("joint").word("name", &self.joint_name(index));
        tag = tag.word("type", kind);
        if joint.kind == JointKind::Hinge {
            tag = tag.numbers("axis", &joint.axis.to_array());
        }
        tag = tag.unless(&[0.0; 3], "pos", &joint.position.to_array());
        if let Some(range) = joint.range {
            tag = tag.numbers("range", &range);
        }
        tag = tag.unless(&[0.0], "armature", &[armature]);
        if let Some(spring) = spring {
            tag = tag
                .numbers("stiffness", &[spring.stiffness])
                .numbers("damping", &[spring.damping])
                .unless(&[0.0], "springref", &[spring.rest]);
        }
        self.leaf(tag.solver_params("solreflimit", "solimplimit", &joint.solver_params));
    }

    fn geoms(&mut self, body: Option<usize>) {
        let geoms = self.model.geoms.iter();
        geoms
            .filter(|geom| geom.body == body)
            .for_each(|geom| self.geom(geom));
    }

    fn geom(&mut self, geom: &Geom) {
        let tag = Tag::new("geom").name(&geom.name);
        let tag = match geom.shape {
            GeomShape::Plane => tag.word("type", "plane").word("size", "0 0 1"),
            GeomShape::Sphere { radius } => tag.word("type", "sphere").numbers("size", &[radius]),
            GeomShape::Capsule { radius, half } => {
                tag.word("type", "capsule").numbers("size", &[radius, half])
            }
            GeomShape::Box { half } => tag.word("type", "box").numbers("size", &half.to_array()),
        };
        let mut tag =
            tag.place(geom.position, geom.rotation)
                .unless(&[1.0], "friction", &[geom.friction]);
        if geom.frictionless {
            tag = tag.word("condim", "1");
        }
        self.leaf(tag.solver_params("solref", "solimp", &geom.solver_params));
    }

    /// The pairs of bodies that are kept apart, besides those that MuJoCo itself keeps so.
    fn contact(&mut self) -> Result<(), UnwritableModel> {
        let model = self.model;
        let touching: BTreeSet<[usize; 2]> = model.pairs.iter().map(sorted).collect();
        let bodies = |pair: &[usize; 2]| sorted(&pair.map(|geom| model.geoms[geom].body));
        let may: BTreeSet<_> = touching.iter().map(bodies).collect();
        let all = 0..model.geoms.len();
        let all = all.flat_map(|second| (0..second).map(move |first| [first, second]));
        let apart = all.filter(|pair| !touching.contains(pair));
        let apart = apart.map(|pair| bodies(&pair));
        let apart: BTreeSet<_> = apart.filter(|pair| self.meet(pair)).collect();
        if let Some(pair) = apart.intersection(&may).next() {
            let [first, second] = pair.map(|body| self.body_name(body));
            return Err(UnwritableModel { first, second });
        }
        if apart.is_empty() {
            return Ok(());
        }
        self.open(Tag::new("contact"));
        for pair in apart {
            let [first, second] = pair.map(|body| self.body_name(body));
            let exclude = Tag::new("exclude").word("body1", &first);
            self.leaf(exclude.word("body2", &second));
        }
        self.close("contact");
        Ok(())
    }

    /// Whether MuJoCo lets shapes of two bodies touch where nothing is said: neither if both are fixed to each other,
    /// nor if one hangs on the other.
    fn meet(&self, bodies: &[Option<usize>; 2]) -> bool {
        let [a, b] = bodies.map(|body| self.weld(body));
        let above = |weld: Option<usize>| self.weld(self.model.bodies[weld?].parent);
        let relatives = a.is_some() && b.is_some() && (above(a) == b || above(b) == a);
        a != b && !relatives
    }

    /// The body with the joints that move this one; none of what stands still.
    fn weld(&self, body: Option<usize>) -> Option<usize> {
        let bodies = &self.model.bodies;
        let mut above = std::iter::successors(body, |&body| bodies[body].parent);
        above.find(|&body| !bodies[body].joints.is_empty())
    }

    fn actuators(&mut self) {
        self.open(Tag::new("actuator"));
        for (index, dof) in self.model.dofs.iter().enumerate() {
            if let Some(drive) = dof.drive {
                self.actuator(dof.joint, index, &drive);
            }
        }
        self.close("actuator");
    }

    fn actuator(&mut self, joint: usize, dof: usize, drive: &Drive) {
        let Joint { kind, v, .. } = self.model.joints[joint];
        let name = self.joint_name(joint);
        let (suffix, gear) = match (kind, dof - v) {
            (JointKind::Ball, 0) => (".x", "1 0 0"),
            (JointKind::Ball, 1) => (".y", "0 1 0"),
            (JointKind::Ball, _) => (".z", "0 0 1"),
            _ => ("", "1"),
        };
        let Drive {
            torque,
            stiffness,
            damping,
            limit,
            control,
        } = *drive;
        let tag = Tag::new(match torque == 0.0 {
            true => "position",
            false => "general",
        });
        let tag = tag.word("name", &format!("{name}{suffix}"));
        let tag = tag.word("joint", &name).word("gear", gear);
        let mut tag = match torque == 0.0 {
            true => tag.numbers("kp", &[stiffness]).numbers("kv", &[damping]),
            false => tag
                .numbers("gainprm", &[torque + stiffness])
                .word("biastype", "affine")
                .numbers("biasprm", &[0.0, -stiffness, -damping]),
        };
        if limit < f32::MAX {
            tag = tag.numbers("forcerange", &[-limit, limit]);
        }
        if control != [f32::MIN, f32::MAX] {
            tag = tag.numbers("ctrlrange", &control);
        }
        self.leaf(tag);
    }

    fn body_name(&self, body: Option<usize>) -> String {
        match body.map(|body| (body, &self.model.bodies[body].name)) {
            None => "world".to_string(),
            Some((index, name)) if name.is_empty() => format!("body{index}"),
            Some((_, name)) => name.clone(),
        }
    }

    fn joint_name(&self, joint: usize) -> String {
        match &self.model.joints[joint].name {
            name if name.is_empty() => format!("joint{joint}"),
            name => name.clone(),
        }
    }
}

fn sorted<T: Copy + Ord>(&[a, b]: &[T; 2]) -> [T; 2] {
    [a.min(b), a.max(b)]
}
