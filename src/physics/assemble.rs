//! Several models in one world.

use super::kinematics::{quaternion, store};
use super::mjcf::ordered;
use super::model::{Body, Dof, Geom, Joint, Kind, Model, Tree};
use glam::{Quat, Vec3};
use std::ops::Range;

/// A model and where it goes.
pub struct Part<'a> {
    /// Goes before the names of its bodies, joints and geoms.
    pub prefix: &'a str,
    pub model: &'a Model,
    /// Where its origin goes, m.
    pub place: Vec3,
    /// About the vertical, rad.
    pub turn: f32,
}

/// One world of all parts, on the ground of the first: what stands still in the others is left out.
/// What moves may touch whatever of other parts there is.
pub fn assemble(parts: &[Part]) -> Model {
    let mut world = Model::default();
    for part in parts {
        add(&mut world, part);
    }
    let names = parts.iter().map(|part| part.model.name.as_str());
    world.name = names.collect::<Vec<_>>().join(" + ");
    world.pairs = ordered(&world.geoms, std::mem::take(&mut world.pairs));
    world
}

fn add(world: &mut Model, part: &Part) {
    let model = part.model;
    let before = Before::of(world);
    touch(world, part, &before);
    let bodies = model.bodies.iter().map(|body| before.body(part, body));
    world.bodies.extend(bodies);
    let joints = model.joints.iter().map(|joint| before.joint(part, joint));
    world.joints.extend(joints);
    world
        .dofs
        .extend(model.dofs.iter().map(|dof| before.dof(dof)));
    world.trees.extend(model.trees.iter().map(|tree| Tree {
        bodies: shifted(&tree.bodies, before.bodies),
        dofs: shifted(&tree.dofs, before.dofs),
    }));
    world.start.extend(start(part));
}

/// How much there was before a part came.
struct Before {
    bodies: usize,
    joints: usize,
    dofs: usize,
    trees: usize,
    positions: usize,
    packed: usize,
}

impl Before {
    fn of(world: &Model) -> Before {
        Before {
            bodies: world.bodies.len(),
            joints: world.joints.len(),
            dofs: world.dofs.len(),
            trees: world.trees.len(),
            positions: world.positions(),
            packed: world.packed(),
        }
    }

    fn body(&self, part: &Part, body: &Body) -> Body {
        let mut body = Body {
            name: part.named(&body.name),
            parent: body.parent.map(|parent| parent + self.bodies),
            joints: shifted(&body.joints, self.joints),
            dofs: shifted(&body.dofs, self.dofs),
            tree: body.tree + self.trees,
            last_dof: body.last_dof.map(|dof| dof + self.dofs),
            ..body.clone()
        };
        if body.parent.is_none() {
            (body.place, body.turn) = part.moved(body.place, body.turn);
        }
        body
    }

    fn joint(&self, part: &Part, joint: &Joint) -> Joint {
        Joint {
            name: part.named(&joint.name),
            body: joint.body + self.bodies,
            q: joint.q + self.positions,
            v: joint.v + self.dofs,
            ..joint.clone()
        }
    }

    fn dof(&self, dof: &Dof) -> Dof {
        Dof {
            joint: dof.joint + self.joints,
            body: dof.body + self.bodies,
            parent: dof.parent.map(|parent| parent + self.dofs),
            row: dof.row + self.packed,
            ..dof.clone()
        }
    }

    fn geom(&self, part: &Part, geom: &Geom) -> Geom {
        Geom {
            name: part.named(&geom.name),
            body: geom.body.map(|body| body + self.bodies),
            ..geom.clone()
        }
    }
}

impl Part<'_> {
    fn named(&self, name: &str) -> String {
        match name {
            "" => String::new(),
            _ => format!("{}{name}", self.prefix),
        }
    }

    fn moved(&self, place: Vec3, turn: Quat) -> (Vec3, Quat) {
        let about = Quat::from_rotation_z(self.turn);
        (self.place + about * place, about * turn)
    }
}

/// Adds geoms, the pairs they are in among themselves, and those with all that was there.
fn touch(world: &mut Model, part: &Part, before: &Before) {
    let (there, first) = (world.geoms.len(), world.geoms.is_empty());
    let mut places = vec![None; part.model.geoms.len()];
    for (place, geom) in places.iter_mut().zip(&part.model.geoms) {
        if first || geom.body.is_some() {
            *place = Some(world.geoms.len());
            world.geoms.push(before.geom(part, geom));
        }
    }
    let own = part.model.pairs.iter();
    let kept = own.filter_map(|&[a, b]| Some([places[a]?, places[b]?]));
    world.pairs.extend(kept);
    let come = there..world.geoms.len();
    let crossed = (0..there).flat_map(|old| come.clone().map(move |new| [old, new]));
    world.pairs.extend(crossed);
}

/// Positions at the start.
fn start(part: &Part) -> Vec<f32> {
    let mut start = part.model.start.clone();
    for joint in part
        .model
        .joints
        .iter()
        .filter(|joint| joint.kind == Kind::Free)
    {
        let q = &mut start[joint.q..];
        let (place, turn) = part.moved(Vec3::from_slice(q), quaternion(&q[3..]));
        q[..3].copy_from_slice(&place.to_array());
        store(&mut q[3..], turn);
    }
    start
}

fn shifted(range: &Range<usize>, by: usize) -> Range<usize> {
    range.start + by..range.end + by
}
