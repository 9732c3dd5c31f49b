//! What a bout has besides its fighters: the ring, and flashes where hands strike.

use super::scene::{Cuboid, Scene};
use super::shapes::seen;
use crate::env::humanoid::boxing::bout::{REMEMBERED, Strike};
use crate::playback::colours::Colour;
use glam::Vec3;

const BORDER: Colour = [0.80, 0.82, 0.86];
/// Half the border's width and half its height, m: flat, so that nobody seems to stumble over it.
const HALF: [f32; 2] = [0.03, 0.004];
/// Brighter than what is lit, so that it glows.
const FLASH: Colour = [3.0, 2.1, 0.5];
/// Radius of a flash, m, at a force of [`FULL`] N; it grows with the force's square root.
const RADIUS: f32 = 0.22;
const FULL: f32 = 500.0;
/// Radii of the largest flash.
const LARGEST: f32 = 1.5;
/// From its middle to its tips, radii.
const SPIKE: f32 = 2.0;

/// Adds the border of an arena of so many metres half its width.
pub fn ring(scene: &mut Scene, arena: f32) {
    let [wide, high] = HALF;
    for side in [-1.0, 1.0] {
        let along_x = ([0.0, side * arena], [arena + wide, wide]);
        let along_y = ([side * arena, 0.0], [wide, arena - wide]);
        for ([x, y], [half_x, half_y]) in [along_x, along_y] {
            scene.cuboids.push(Cuboid {
                centre: seen(Vec3::new(x, y, high)).to_array(),
                half: seen(Vec3::new(half_x, half_y, high)).abs().to_array(),
                rotation: Cuboid::UPRIGHT,
                colour: BORDER,
            });
        }
    }
}

/// Adds a flash for each strike: a star, the larger the harder it was, that shrinks as it ages.
pub fn flashes(scene: &mut Scene, strikes: &[Strike]) {
    for strike in strikes {
        let fresh = 1.0 - strike.age as f32 / REMEMBERED as f32;
        let radius = RADIUS * fresh * (strike.force / FULL).sqrt().min(LARGEST);
        star(scene, seen(strike.at), radius);
    }
}

fn star(scene: &mut Scene, at: Vec3, radius: f32) {
    scene.ball(at, 0.6 * radius, FLASH);
    let signs = [-1.0, 1.0];
    let axes = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| signs.map(|sign| sign * axis));
    let corners = signs.map(|x| signs.map(|y| signs.map(|z| Vec3::new(x, y, z).normalize())));
    let corners = corners.as_flattened().as_flattened();
    for way in axes.as_flattened().iter().chain(corners) {
        scene.tip(at, 0.35 * radius, at + SPIKE * radius * way, FLASH);
    }
}
