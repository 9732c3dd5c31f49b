//! Scenes of a simulated body: the forces on it, and beside it what it is to move like.

use super::body_playthrough::{BodyContext, BodyPlaythrough, BodyPush, TouchForce};
use super::bout_scene::{flashes, ring};
use super::camera::Camera;
use super::scene::Scene;
use super::shapes::{self, Look, seen};
use crate::physics::kinematics::{quaternion, store};
use crate::playback::colours::Colour;
use glam::{Quat, Vec3};

/// Length of an arrow, m a newton: half the weight of the body is half a metre.
pub const ARROW: f32 = 0.002;
const RADIUS: f32 = 0.016;
const TOUCH: Colour = [0.05, 0.50, 0.20];
const PUSH: Colour = [0.80, 0.06, 0.10];
/// From the body to the recorded one: to the right of the picture, and away, m.
const ASIDE: [f32; 2] = [0.9, 0.5];

/// What is drawn besides the bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BodyExtras {
    /// An arrow a force between two shapes that touch.
    pub forces: bool,
    /// The recorded frame.
    pub reference: bool,
}

/// The scene of a moment, with a push that is about to come.
pub fn body_scene(
    moment: &BodyPlaythrough,
    context: &BodyContext,
    push: Option<BodyPush>,
    extras: BodyExtras,
    camera: &Camera,
) -> Scene {
    let (mut scene, model) = (Scene::default(), context.model());
    let poses = shapes::poses(model, &moment.q);
    shapes::draw(&mut scene, model, &poses, Vec3::ZERO, Look::Solid);
    if extras.forces {
        for TouchForce { at, force } in &moment.touching {
            arrow(&mut scene, *at, *force, TOUCH);
        }
    }
    if let (Some(bout), Some(task)) = (&moment.bout, &context.episodes().bouts) {
        ring(&mut scene, task.boxing().arena);
        flashes(&mut scene, &bout.strikes);
    }
    if let Some(push) = push.or(moment.push) {
        let centre = poses[push.body].at(model.bodies[push.body].com);
        arrow(&mut scene, centre, push.force, PUSH);
    }
    if extras.reference {
        reference(&mut scene, moment, context, camera);
    }
    scene
}

fn arrow(scene: &mut Scene, from: Vec3, force: Vec3, colour: Colour) {
    let from = seen(from);
    scene.arrow(from, from + ARROW * seen(force), RADIUS, colour);
}

/// The body that it is to be like, beside it whichever way that goes.
fn reference(scene: &mut Scene, moment: &BodyPlaythrough, context: &BodyContext, camera: &Camera) {
    let Some(reference) = &context.reference else {
        return;
    };
    let nearest = moment.reference.map(|frame| reference.q(frame));
    let Some(mut q) = moment.wanted.clone().or(nearest) else {
        return;
    };
    let turn = Quat::from_rotation_z(heading(&moment.q) - heading(&q));
    let turned = turn * quaternion(&q[3..]);
    q[..2].copy_from_slice(&moment.q[..2]);
    store(&mut q[3..], turned);
    let poses = shapes::poses(reference.model(), &q);
    let aside = camera.over_ground(ASIDE);
    shapes::draw(scene, reference.model(), &poses, aside, Look::Ghost);
}

/// Which way a root faces on the ground, rad.
fn heading(q: &[f32]) -> f32 {
    let forward = quaternion(&q[3..]) * Vec3::X;
    forward.y.atan2(forward.x)
}
