//! A character as it is exported: its motion, and what it looks like.

use crate::motion::clip::Clip;
use crate::physics::model::{Geom, GeomShape, Model};
use crate::physics::motion_clip::MotionClip;
use crate::physics::pose::Y_UP;
use crate::physics::skeleton_clip::skeleton_clip;
use crate::playback::capsule_rig::{Bone, Spot};
use crate::playback::colours::{Colour, body_colour};
use glam::{Quat, Vec3};

/// A character of an episode. Metres, y up.
pub struct MovingCharacter {
    /// Its motion.
    pub clip: Clip,
    /// Its capsules and balls.
    pub bones: Vec<Bone>,
    /// Its boxes.
    pub cuboids: Vec<JointCuboid>,
}

/// A box that moves with a joint.
pub struct JointCuboid {
    /// Number of the joint.
    pub joint: usize,
    /// Centre in the joint's frame, m.
    pub position: Vec3,
    /// Rotation in the joint's frame.
    pub rotation: Quat,
    /// Half its sides, m.
    pub half: Vec3,
    /// Colour of the surface.
    pub colour: Colour,
}

impl MovingCharacter {
    /// One of a simulated model's trees.
    pub fn of_tree(model: &Model, tree: usize, motion: &MotionClip) -> MovingCharacter {
        let mut character = MovingCharacter {
            clip: skeleton_clip(model, tree, motion),
            bones: Vec::new(),
            cuboids: Vec::new(),
        };
        for geom in &model.geoms {
            if let Some(body) = geom.body.filter(|&body| model.bodies[body].tree == tree) {
                let colour = body_colour(&model.bodies[body].name, model.is_alone(body));
                let joint = body - model.trees[tree].bodies.start;
                character.add(geom, joint, colour);
            }
        }
        character
    }

    fn add(&mut self, geom: &Geom, joint: usize, colour: Colour) {
        let mut capsule = |radius: f32, half: f32| {
            let ends = [-half, half].map(|along| Spot {
                joint,
                offset: Y_UP * (geom.position + geom.rotation * Vec3::Z * along),
                radius,
            });
            self.bones.push(Bone { ends, colour });
        };
        match geom.shape {
            GeomShape::Plane => {}
            GeomShape::Sphere { radius } => capsule(radius, 0.0),
            GeomShape::Capsule { radius, half } => capsule(radius, half),
            GeomShape::Box { half } => self.cuboids.push(JointCuboid {
                joint,
                position: Y_UP * geom.position,
                rotation: Y_UP * geom.rotation,
                half,
                colour,
            }),
        }
    }
}
