//! The bodies of `worldbody`, with their joints and geoms, as a model without drives and pairs.

use super::class::Classes;
use super::element::Element;
use super::error::Result;
use super::frame::Frame;
use super::geom::{self, Bits, Solid};
use super::grammar::{BODY, GEOM, INERTIAL, WORLD};
use super::joint::{self, Jointed};
use super::mass::Mass;
use super::settings::MjcfSettings;
use crate::physics::model::{Body, Dof, GeomShape, JointKind, KinematicTree, Model};
use std::collections::{HashMap, HashSet};

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
    pub mass: Mass,
    /// Its frame seen from its body's or, of what cannot move, from the world's.
    frame: Frame,
    /// Mass of what is in it.
    class: Option<usize>,
}

pub struct WorldBuilder<'a> {
    pub settings: &'a MjcfSettings,
    pub classes: &'a Classes<'a>,
    pub model: Model,
    pub elements: Vec<BodyElement<'a>>,
    /// The element of each of the model's geoms, and what it may touch.
    pub touching: Vec<(usize, Bits)>,
    /// The element of each of the model's joints, and its spring and damper.
    pub joints: Vec<(Element<'a>, [f32; 2])>,
    names: HashSet<(&'a str, &'a str)>,
}

impl<'a> WorldBuilder<'a> {
    pub fn read(
        root: &Element<'a>,
        settings: &'a MjcfSettings,
        classes: &'a Classes<'a>,
    ) -> Result<Self> {
        let mut world = WorldBuilder {
            settings,
            classes,
            model: Model::default(),
            elements: Vec::new(),
            touching: Vec::new(),
            joints: Vec::new(),
            names: HashSet::new(),
        };
        let tops: Vec<Element> = root.sections("worldbody").collect();
        world.ground(root, &tops)?;
        let mut known: HashMap<_, _> = tops.iter().map(|top| (top.id(), 0)).collect();
        // In the file's order parents come before their children.
        for element in tops.iter().flat_map(|top| top.nested("body")) {
            let parent = element.parent().and_then(|parent| known.get(&parent));
            let index = world.body(&element, parent.copied().unwrap_or(0))?;
            known.insert(element.id(), index);
        }
        world.solve_lt()?;
        Ok(world)
    }

    /// The world, and what stands in it.
    fn ground(&mut self, root: &Element<'a>, tops: &[Element<'a>]) -> Result<()> {
        self.elements.push(BodyElement {
            element: root.clone(),
            parent: 0,
            body: None,
            weld: 0,
            mass: Mass::default(),
            frame: Frame::default(),
            class: None,
        });
        for top in tops {
            top.check(&WORLD)?;
            for geom in top.sections("geom") {
                self.geom(geom, 0)?;
            }
        }
        Ok(())
    }

    /// A body without those within.
    fn body(&mut self, element: &Element<'a>, parent: usize) -> Result<usize> {
        element.check(&BODY)?;
        self.name(element)?;
        let outer = &self.elements[parent];
        let class = self.classes.of_children(element)?.or(outer.class);
        let joints = self.joints_of(element, parent, class)?;
        let moves = !joints.is_empty() || outer.body.is_some();
        let frame = outer.frame * Frame::read(element, self.settings)?;
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
            mass: Mass::default(),
            frame: if moves { Frame::default() } else { frame },
            class,
        });
        self.elements[index].mass = self.contents(element, index)?;
        Ok(index)
    }

    fn joints_of(
        &self,
        element: &Element<'a>,
        parent: usize,
        class: Option<usize>,
    ) -> Result<Vec<Jointed<'a>>> {
        let mut joints = Vec::new();
        for child in element.children() {
            let child = match child.tag() {
                "joint" => self.classes.apply(child, class)?,
                "freejoint" => child,
                _ => continue,
            };
            joints.push(joint::read(child, self.settings)?);
        }
        together(&joints)?;
        let free = joints
            .iter()
            .find(|read| read.joint.kind == JointKind::Free);
        match free.filter(|_| parent != 0) {
            None => Ok(joints),
            Some(free) => {
                let problem =
                    "is free below another body; only bodies of <worldbody> itself can be";
                Err(free.element.error(problem))
            }
        }
    }

    /// Mass of the geoms, which it adds, or what is said instead.
    fn contents(&mut self, element: &Element<'a>, index: usize) -> Result<Mass> {
        let mut parts = Vec::new();
        for geom in element.sections("geom") {
            parts.push(self.geom(geom, index)?);
        }
        let said: Vec<Element> = element.sections("inertial").collect();
        let mut mass = Mass::sum(&parts);
        for inertial in &said {
            inertial.check(&INERTIAL)?;
            let said = Mass::read(inertial, self.settings)?;
            mass = if self.settings.from_geoms { mass } else { said };
        }
        match said.get(1) {
            Some(second) => Err(second.error("is the second in its body; keep one")),
            None => Ok(mass),
        }
    }

    /// A body of the model, whose joints and mass are yet to come.
    fn begin(&mut self, element: &Element<'a>, parent: usize, frame: &Frame) -> Result<usize> {
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
    fn joint(&mut self, read: Jointed<'a>, frame: &Frame) -> Result<()> {
        self.name(&read.element)?;
        let model = &mut self.model;
        if model.joints.len() == MOST {
            let problem = format!("is one joint too many: there may be {MOST}");
            return Err(read.element.error(&problem));
        }
        let body = model.bodies.len() - 1;
        let mut joint = read.joint;
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
        self.joints.push((read.element, read.gains));
        Ok(())
    }

    /// Adds a geom, unless it touches nothing: then it has done its work with its mass.
    fn geom(&mut self, child: Element<'a>, index: usize) -> Result<Mass> {
        self.name(&child)?;
        let class = self.elements[index].class;
        let element = self.classes.apply(child, class)?;
        element.check(&GEOM)?;
        let Solid {
            mut geom,
            frame,
            mass,
            bits,
        } = geom::read(&element, self.settings)?;
        let around = &self.elements[index];
        if geom.shape == GeomShape::Plane && around.body.is_some() {
            return Err(element.wrong("type", "a plane cannot be in a body that moves"));
        }
        if self.model.geoms.len() == MOST {
            return Err(element.error(&format!("is one geom too many: there may be {MOST}")));
        }
        if bits.any() {
            let frame = around.frame * frame;
            geom.body = around.body;
            (geom.position, geom.rotation) = (frame.position.as_vec3(), frame.rotation.as_quat());
            self.model.geoms.push(geom);
            self.touching.push((index, bits));
        }
        Ok(mass)
    }

    /// Hands the masses to the model, and refuses what would move without any.
    fn solve_lt(&mut self) -> Result<()> {
        for (index, known) in self.elements.iter().enumerate() {
            let Some(body) = known.body else { continue };
            let mut welded = self.elements.iter().filter(|other| other.weld == index);
            if known.weld == index && !welded.any(|other| other.mass.can_move()) {
                let problem = "moves but has no mass; give it a geom, or <inertial>";
                return Err(known.element.error(problem));
            }
            let body = &mut self.model.bodies[body];
            body.mass = known.mass.mass as f32;
            body.com = known.mass.com.as_vec3();
            body.inertia = known.mass.inertia.as_mat3();
            if !(body.mass.is_finite() && body.inertia.is_finite()) {
                let problem = "is too heavy to be reckoned with; check its sizes and density";
                return Err(known.element.error(problem));
            }
        }
        Ok(())
    }

    /// Takes an element's name: there may be none other of its kind.
    pub fn name(&mut self, element: &Element<'a>) -> Result<()> {
        let name = element.name();
        let kind = match element.tag() {
            "freejoint" => "joint",
            "motor" | "position" => "actuator",
            tag => tag,
        };
        let world = kind == "body" && name == "world";
        match name.is_empty() || (!world && self.names.insert((kind, name))) {
            true => Ok(()),
            false => Err(element.wrong("name", &format!("another {kind} has this name"))),
        }
    }
}

/// Refuses joints that one body cannot have together.
fn together(joints: &[Jointed]) -> Result<()> {
    let several = joints.len() > 1;
    let free = joints
        .iter()
        .find(|read| read.joint.kind == JointKind::Free);
    if let Some(free) = free.filter(|_| several) {
        let problem = "is free; a body that has such a joint has no other";
        return Err(free.element.error(problem));
    }
    // A ball turns every way: what comes behind it would add nothing.
    let behind = joints
        .windows(2)
        .find(|two| two[0].joint.kind == JointKind::Ball);
    match behind {
        Some(two) => Err(two[1]
            .element
            .error("comes after a ball joint of its body; that must be the last")),
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
        drive: None,
        invweight0: 0.0,
    });
    let body = &mut model.bodies[body];
    body.dofs.end = index + 1;
    body.last_dof = Some(index);
    model.trees[body.tree].dofs.end = index + 1;
}
