//! Several models in one world.

use super::kinematics::{quaternion, store};
use super::mjcf::ordered;
use super::model::{Body, Dof, Geom, Joint, JointKind, KinematicTree, Model};
use glam::{Quat, Vec3};
use std::ops::Range;

/// A model and where it is put.
pub struct Part<'a> {
    /// Prefix of the names of its bodies, joints and geoms.
    pub prefix: &'a str,
    /// Model whose bodies, joints and geoms the part adds.
    pub model: &'a Model,
    /// Position of its origin in the world, m.
    pub position: Vec3,
    /// Rotation about the vertical, rad.
    pub yaw: f32,
}

/// Joins all parts in one world, on the ground of the first: what stands still in the others is left out.
/// What moves may touch everything of the other parts.
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
    let offsets = Offsets::of(world);
    touch(world, part, &offsets);
    let bodies = model.bodies.iter().map(|body| offsets.body(part, body));
    world.bodies.extend(bodies);
    let joints = model.joints.iter().map(|joint| offsets.joint(part, joint));
    world.joints.extend(joints);
    world
        .dofs
        .extend(model.dofs.iter().map(|dof| offsets.dof(dof)));
    world
        .trees
        .extend(model.trees.iter().map(|tree| KinematicTree {
            bodies: shifted(&tree.bodies, offsets.bodies),
            dofs: shifted(&tree.dofs, offsets.dofs),
        }));
    world.qpos0.extend(qpos0(part));
}

/// What a world holds when a part is added to it.
struct Offsets {
    bodies: usize,
    joints: usize,
    dofs: usize,
    trees: usize,
    positions: usize,
    packed: usize,
}

impl Offsets {
    fn of(world: &Model) -> Offsets {
        Offsets {
            bodies: world.bodies.len(),
            joints: world.joints.len(),
            dofs: world.dofs.len(),
            trees: world.trees.len(),
            positions: world.nq(),
            packed: world.nm(),
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
            (body.position, body.rotation) = part.moved(body.position, body.rotation);
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

    fn moved(&self, position: Vec3, rotation: Quat) -> (Vec3, Quat) {
        let about = Quat::from_rotation_z(self.yaw);
        (self.position + about * position, about * rotation)
    }
}

/// Adds geoms, the pairs they are in among themselves, and those with all that was there.
fn touch(world: &mut Model, part: &Part, offsets: &Offsets) {
    let (there, first) = (world.geoms.len(), world.geoms.is_empty());
    let mut places = vec![None; part.model.geoms.len()];
    for (position, geom) in places.iter_mut().zip(&part.model.geoms) {
        if first || geom.body.is_some() {
            *position = Some(world.geoms.len());
            world.geoms.push(offsets.geom(part, geom));
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
fn qpos0(part: &Part) -> Vec<f32> {
    let mut qpos0 = part.model.qpos0.clone();
    for joint in part
        .model
        .joints
        .iter()
        .filter(|joint| joint.kind == JointKind::Free)
    {
        let q = &mut qpos0[joint.q..];
        let (position, rotation) = part.moved(Vec3::from_slice(q), quaternion(&q[3..]));
        q[..3].copy_from_slice(&position.to_array());
        store(&mut q[3..], rotation);
    }
    qpos0
}

fn shifted(range: &Range<usize>, by: usize) -> Range<usize> {
    range.start + by..range.end + by
}
