//! Scenes of a playthrough: the character, its target, obstacles and trajectories.

use super::scene::{Cuboid, Scene};
use crate::env::locomotion::LocomotionTask;
use crate::kernels::termination;
use crate::playback::PlacedFrame;
use crate::playback::colours::Colour;
use crate::train::playthrough::{Playthrough, PlaythroughContext};
use glam::Vec3;

const TARGET: Colour = [0.06, 0.50, 0.22];
/// Colour of the requested trajectory.
pub const REQUESTED: Colour = [0.90, 0.36, 0.02];
/// Colour of the matched trajectory.
pub const MATCHED: Colour = [0.02, 0.34, 0.75];
const OBSTACLE: Colour = [0.42, 0.34, 0.30];
const HIT_OBSTACLE: Colour = [0.75, 0.05, 0.03];
/// Height of obstacles, m: low enough to see the character behind them.
const HEIGHT: f32 = 0.35;

/// The scene of a playthrough.
pub fn scene(playthrough: &Playthrough, context: &PlaythroughContext) -> Scene {
    let mut scene = untargeted(playthrough, context);
    let radius = match context.task {
        LocomotionTask::Plane(plane) => plane.success_radius,
        LocomotionTask::Obstacles(obstacles) => obstacles.success_radius,
    };
    target(&mut scene, playthrough.target(), radius);
    obstacles(&mut scene, playthrough);
    scene
}

/// The character and its trajectories alone.
pub fn untargeted(playthrough: &Playthrough, context: &PlaythroughContext) -> Scene {
    let mut scene = Scene::default();
    let database = context.database();
    scene.character(&context.rig, &database.skeleton, &playthrough.pose);
    if let Some(step) = &playthrough.step {
        let from = step.from;
        trajectory(&mut scene, from.at, &step.requested, REQUESTED);
        let matched = PlacedFrame {
            frame: step.matched,
            ..from
        };
        trajectory(&mut scene, from.at, &matched.path(database), MATCHED);
    }
    scene
}

fn on_ground(at: [f32; 2], height: f32) -> Vec3 {
    Vec3::new(at[0], height, at[1])
}

/// A ring of the radius within which it counts as reached, and a pole in its middle.
fn target(scene: &mut Scene, at: [f32; 2], radius: f32) {
    const CORNERS: usize = 40;
    let ring: Vec<Vec3> = (0..=CORNERS)
        .map(|corner| {
            let angle = std::f32::consts::TAU * corner as f32 / CORNERS as f32;
            on_ground(
                [at[0] + radius * angle.sin(), at[1] + radius * angle.cos()],
                0.01,
            )
        })
        .collect();
    scene.rod(&ring, 0.02, TARGET);
    scene.rod(&[on_ground(at, 0.0), on_ground(at, 1.6)], 0.02, TARGET);
    scene.ball(on_ground(at, 1.6), 0.1, TARGET);
}

fn obstacles(scene: &mut Scene, playthrough: &Playthrough) {
    let struck = playthrough
        .step
        .as_ref()
        .is_some_and(|step| step.termination == termination::FAILED);
    let at = playthrough.shown.at;
    for (slot, [x, z, half_x, half_z]) in playthrough.obstacles().into_iter().enumerate() {
        let hit = struck && (x - at[0]).abs() <= half_x && (z - at[1]).abs() <= half_z;
        // Obstacles overlap: each has its own height and shade. Steps of the golden ratio never meet.
        let own = (slot as f32 * 0.618_034).fract();
        let height = HEIGHT * (0.8 + 0.4 * own);
        scene.cuboids.push(Cuboid {
            centre: [x, 0.5 * height, z],
            half: [half_x, 0.5 * height, half_z],
            rotation: Cuboid::UPRIGHT,
            colour: match hit {
                true => HIT_OBSTACLE,
                false => OBSTACLE.map(|value| value * (0.75 + 0.5 * own)),
            },
        });
    }
}

/// A line through the points of a trajectory, with an arrow each for the direction to face.
pub fn trajectory(scene: &mut Scene, from: [f32; 2], points: &[[f32; 4]], colour: Colour) {
    const ABOVE: f32 = 0.025;
    let places = std::iter::once(from).chain(points.iter().map(|p| [p[0], p[1]]));
    let line: Vec<Vec3> = places.map(|at| on_ground(at, ABOVE)).collect();
    scene.rod(&line, 0.015, colour);
    for &[x, z, hx, hz] in points {
        let base = on_ground([x, z], ABOVE);
        scene.ball(base, 0.04, colour);
        scene.tip(base, 0.04, base + 0.28 * Vec3::new(hx, 0.0, hz), colour);
    }
}
