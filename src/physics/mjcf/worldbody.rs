//! The bodies of `worldbody`, with their joints and geoms, as a model without drives and pairs.

use super::class::Classes;
use super::element::Element;
use super::error::Checked;
use super::frame::Frame;
use super::geom::{self, Bits, Solid};
use super::grammar::{BODY, GEOM, INERTIAL, WORLD};
use super::joint::{self, Jointed};
use super::mass::Mass;
use super::member::Member;
use super::settings::{MassSource, MjcfSettings};
use crate::physics::model::{Body, Dof, GeomShape, JointKind, KinematicTree, Model};
use std::collections::HashSet;

/// Bodies, joints and geoms at most, each: more are a mistake, or an attack.
const MOST: usize = 200;

/// A body of the file, or the world, which is the first. What cannot move is part of the world, and
/// none of the model's bodies.
pub struct BodyElement<'a> {
    pub element: Element<'a>,
    pub parent: usize,
    pub body: Option<usize>,
    /// The element with the joints that move this one.
    pub weld: usize,
    /// Mass of what is in it; none if that could not be read.
    pub mass: Option<Mass>,
    /// Its frame seen from its body's or, of what cannot move, from the world's.
    frame: Frame,
}

pub struct WorldBuilder<'a> {
    pub settings: &'a MjcfSettings,
    pub classes: &'a Classes<'a>,
    pub model: Model,
    pub elements: Vec<BodyElement<'a>>,
    /// The element of each of the model's geoms, and what it may touch.
    pub touching: Vec<(usize, Bits)>,
    /// What the file says of each of the model's joints.
    pub joints: Vec<Jointed<'a>>,
    names: HashSet<(&'a str, &'a str)>,
    /// Kinds of elements some of which are not known by their names.
    misnamed: HashSet<&'a str>,
}

impl<'a> WorldBuilder<'a> {
    pub fn read(root: &Element<'a>, settings: &'a MjcfSettings, classes: &'a Classes<'a>) -> Self {
        let mut world = WorldBuilder {
            settings,
            classes,
            model: Model::default(),
            elements: Vec::new(),
            touching: Vec::new(),
            joints: Vec::new(),
            names: HashSet::new(),
            misnamed: HashSet::new(),
        };
        let bodies = world.bodies(root);
        if root.keep(bodies).is_none() {
            // What comes after is not known.
            world.misnamed.extend(["body", "joint"]);
        }
        world.masses();
        world
    }

    /// The world, and all that stands in it; gives up where there is too much of it.
    fn bodies(&mut self, root: &Element<'a>) -> Checked<()> {
        self.elements.push(BodyElement {
            element: root.clone(),
            parent: 0,
            body: None,
            weld: 0,
            mass: Some(Mass::default()),
            frame: Frame::default(),
        });
        let mut open = Vec::new();
        for top in root.sections("worldbody") {
            top.check(&WORLD);
            let members = Member::all(&top, None, self.classes, self.settings);
            for member in members {
                match member.element.tag() {
                    "body" => open.push((member, 0)),
                    "geom" => drop(self.geom(&member, 0, true)?),
                    _ => {}
                }
            }
        }
        open.reverse();
        // In the file's order parents come before their children.
        while let Some((member, parent)) = open.pop() {
            let from = open.len();
            let index = self.elements.len();
            let within = self.body(member, parent)?;
            open.extend(within.into_iter().map(|member| (member, index)));
            open[from..].reverse();
        }
        Ok(())
    }

    /// A body; returns those within.
    fn body(&mut self, member: Member<'a>, parent: usize) -> Checked<Vec<Member<'a>>> {
        let element = &member.element;
        element.check(&BODY);
        self.name(element);
        let class = self.classes.of_children(element).or(member.class);
        let members = Member::all(element, class, self.classes, self.settings);
        let joints = self.joints_of(&members, parent);
        let outer = &self.elements[parent];
        let moves = !joints.is_empty() || outer.body.is_some();
        let own = element.keep(Frame::read(element, self.settings));
        let frame = outer.frame * member.place(own.unwrap_or_default());
        let index = self.elements.len();
        let weld = if joints.is_empty() { outer.weld } else { index };
        let body = match moves {
            true => Some(self.begin(element, parent, &frame)?),
            false => None,
        };
        for joint in joints {
            self.joint(joint, &frame)?;
        }
        self.elements.push(BodyElement {
            element: element.clone(),
            parent,
            body,
            weld,
            mass: None,
            frame: if moves { Frame::default() } else { frame },
        });
        self.elements[index].mass = self.contents(&members, index)?;
        let bodies = members.into_iter();
        Ok(bodies
            .filter(|member| member.element.tag() == "body")
            .collect())
    }

    fn joints_of(&self, members: &[Member<'a>], parent: usize) -> Vec<Jointed<'a>> {
        let mut joints = Vec::new();
        for member in members {
            let element = member.element.clone();
            let element = match element.tag() {
                "joint" => self.classes.apply(element, member.class),
                "freejoint" => element,
                _ => continue,
            };
            joints.push(joint::read(element, member, self.settings));
        }
        if let Err((element, problem)) = together(&joints, parent) {
            element.report(element.error(problem));
            // What drives it shall not be refused for it, too.
            joints
                .iter_mut()
                .for_each(|read| read.joint.kind = JointKind::Hinge);
        }
        joints
    }

    /// Mass of the geoms, which it adds, or what is said instead; none if some of it is wrong.
    fn contents(&mut self, members: &[Member<'a>], index: usize) -> Checked<Option<Mass>> {
        let of = |tag: &'static str| {
            members
                .iter()
                .filter(move |member| member.element.tag() == tag)
        };
        let mut said = None;
        for (count, member) in of("inertial").enumerate() {
            let element = &member.element;
            element.check(&INERTIAL);
            if count > 0 {
                element.report(element.error("is the second in its body; keep one"));
            }
            said = Some(element.keep(Mass::read(element, self.settings)));
        }
        let counts = match self.settings.masses {
            MassSource::Geoms => true,
            MassSource::Inertial => false,
            MassSource::Auto => said.is_none(),
        };
        let mut parts = Vec::new();
        for member in of("geom") {
            parts.push(self.geom(member, index, counts)?);
        }
        match counts {
            true => {
                let parts: Option<Vec<Mass>> = parts.into_iter().collect();
                Ok(parts.map(|parts| Mass::sum(&parts)))
            }
            false => Ok(said.unwrap_or(Some(Mass::default()))),
        }
    }

    /// A body of the model, whose joints and mass are yet to come.
    fn begin(&mut self, element: &Element<'a>, parent: usize, frame: &Frame) -> Checked<usize> {
        let model = &mut self.model;
        let index = model.bodies.len();
        if index == MOST {
            return Err(element.error(&format!("is one body too many: {MOST} may move")));
        }
        let parent = self.elements[parent].body;
        let (joint, dof) = (model.joints.len(), model.dofs.len());
        if parent.is_none() {
            model.trees.push(KinematicTree {
                bodies: index..index,
                dofs: dof..dof,
            });
        }
        model.bodies.push(Body {
            name: element.name().to_string(),
            parent,
            position: frame.position.as_vec3(),
            rotation: frame.rotation.as_quat(),
            mass: 0.0,
            com: Default::default(),
            inertia: Default::default(),
            joints: joint..joint,
            dofs: dof..dof,
            tree: model.trees.len() - 1,
            last_dof: parent.and_then(|parent| model.bodies[parent].last_dof),
            invweight0: 0.0,
        });
        model.trees[model.bodies[index].tree].bodies.end = index + 1;
        Ok(index)
    }

    /// A joint of the body that began last, and where it stands at the start.
    fn joint(&mut self, read: Jointed<'a>, frame: &Frame) -> Checked<()> {
        self.name(&read.element);
        let model = &mut self.model;
        if model.joints.len() == MOST {
            let problem = format!("is one joint too many: there may be {MOST}");
            return Err(read.element.error(&problem));
        }
        let body = model.bodies.len() - 1;
        let mut joint = read.joint.clone();
        (joint.body, joint.q, joint.v) = (body, model.qpos0.len(), model.dofs.len());
        let (position, rotation) = (frame.position.as_vec3(), frame.rotation.as_quat());
        match joint.kind {
            JointKind::Free => {
                model.qpos0.extend(position.to_array());
                model
                    .qpos0
                    .extend([rotation.w, rotation.x, rotation.y, rotation.z]);
            }
            JointKind::Ball => model.qpos0.extend([1.0, 0.0, 0.0, 0.0]),
            JointKind::Hinge => model.qpos0.push(0.0),
        }
        for _ in 0..joint.kind.nv() {
            dof(model, read.armature);
        }
        model.bodies[body].joints.end += 1;
        model.joints.push(joint);
        self.joints.push(read);
        Ok(())
    }

    /// Adds a geom, unless it touches nothing: then it has done its work with its mass, if that counts.
    /// None if it could not be read.
    fn geom(&mut self, member: &Member<'a>, index: usize, counts: bool) -> Checked<Option<Mass>> {
        self.name(&member.element);
        let element = self.classes.apply(member.element.clone(), member.class);
        element.check(&GEOM);
        if self.model.geoms.len() == MOST {
            return Err(element.error(&format!("is one geom too many: there may be {MOST}")));
        }
        // What cannot move may weigh what it likes.
        let weighs = counts && self.elements[index].body.is_some();
        let read = geom::read(member, &element, self.settings, weighs);
        let Some(Solid { touching, mass }) = element.keep(read) else {
            return Ok(None);
        };
        let Some((mut geom, frame, bits)) = touching else {
            return Ok(Some(mass));
        };
        let around = &self.elements[index];
        if geom.shape == GeomShape::Plane && around.body.is_some() {
            element.report(element.wrong("type", "a plane cannot be in a body that moves"));
            return Ok(None);
        }
        let frame = around.frame * frame;
        geom.body = around.body;
        (geom.position, geom.rotation) = (frame.position.as_vec3(), frame.rotation.as_quat());
        self.model.geoms.push(geom);
        self.touching.push((index, bits));
        Ok(Some(mass))
    }

    /// Hands the masses to the model, and refuses what would move without any.
    fn masses(&mut self) {
        for (index, known) in self.elements.iter().enumerate() {
            let (Some(body), Some(mass)) = (known.body, known.mass) else {
                continue;
            };
            let mut welded = self.elements.iter().filter(|other| other.weld == index);
            let heavy = |other: &BodyElement| other.mass.is_none_or(|mass| mass.can_move());
            if known.weld == index && !welded.any(heavy) {
                let problem = "moves but has no mass; give it a geom, or <inertial>";
                known.element.report(known.element.error(problem));
            }
            let body = &mut self.model.bodies[body];
            body.mass = mass.mass as f32;
            body.com = mass.com.as_vec3();
            body.inertia = mass.inertia.as_mat3();
            if !(body.mass.is_finite() && body.inertia.is_finite()) {
                let problem = "is too heavy to be reckoned with; check its sizes and density";
                known.element.report(known.element.error(problem));
            }
        }
    }

    /// Takes an element's name: there may be none other of its kind.
    pub fn name(&mut self, element: &Element<'a>) {
        let name = element.name();
        let kind = match element.tag() {
            "freejoint" => "joint",
            "general" | "motor" | "position" => "actuator",
            tag => tag,
        };
        let world = kind == "body" && name == "world";
        if !name.is_empty() && (world || !self.names.insert((kind, name))) {
            self.misnamed.insert(kind);
            element.report(element.wrong("name", &format!("another {kind} has this name")));
        }
    }

    /// Whether what has a name of this kind is known by it.
    pub fn named_all(&self, kind: &str) -> bool {
        !self.misnamed.contains(kind)
    }
}

/// Refuses joints that one body cannot have together, or in a body within body `parent`.
fn together<'b, 'a>(
    joints: &'b [Jointed<'a>],
    parent: usize,
) -> Result<(), (&'b Element<'a>, &'static str)> {
    let free = joints
        .iter()
        .find(|read| read.joint.kind == JointKind::Free);
    if let Some(free) = free {
        if joints.len() > 1 {
            let problem = "is free; a body that has such a joint has no other";
            return Err((&free.element, problem));
        }
        if parent != 0 {
            let problem = "is free below another body; only bodies of <worldbody> itself can be";
            return Err((&free.element, problem));
        }
    }
    // A ball turns every way: what comes behind it would add nothing.
    let behind = joints
        .windows(2)
        .find(|two| two[0].joint.kind == JointKind::Ball);
    match behind {
        Some(two) => {
            let problem = "comes after a ball joint of its body; that must be the last";
            Err((&two[1].element, problem))
        }
        None => Ok(()),
    }
}

/// A degree of freedom of the joint that comes next.
fn dof(model: &mut Model, armature: f32) {
    let (index, body) = (model.dofs.len(), model.bodies.len() - 1);
    let parent = model.bodies[body].last_dof;
    let above = parent.map(|parent| &model.dofs[parent]);
    let last = model.dofs.last();
    model.dofs.push(Dof {
        joint: model.joints.len(),
        body,
        parent,
        depth: above.map_or(0, |above| above.depth) + 1,
        row: last.map_or(0, |last| last.row + last.depth),
        armature,
        spring: None,
        drive: None,
        invweight0: 0.0,
    });
    let body = &mut model.bodies[body];
    body.dofs.end = index + 1;
    body.last_dof = Some(index);
    model.trees[body.tree].dofs.end = index + 1;
}
