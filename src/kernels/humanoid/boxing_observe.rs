//! What the task `box` adds to the observation of the body. Shader: `shaders/humanoid/boxing_observe.wgsl`.

use super::fighters::{FIGHTERS, FighterBodies, Fighters};
use crate::gpu::{Buffer, Gpu, groups, shader};
use crate::kernels::physics::collision::poses_of;
use crate::kernels::physics::proprioception::{in_heading_frame, rotation};
use crate::kernels::physics::smooth_dynamics::spatial;
use crate::kernels::physics::strided::gather;
use crate::physics::spatial::Spatial;
use glam::{Vec2, Vec3};

crate::shader_params! {
    pub struct Params for boxing_observe {
        /// Environments of the batch.
        pub envs: u32,
        /// Index of the first number.
        pub at: u32,
        /// Numbers from one row to the next.
        pub width: u32,
        /// The environments to observe: those whose step ended as one of these, `1 << termination`.
        pub only: u32,
        /// Index of the velocities in what `smooth_dynamics` leaves.
        pub velocities_at: u32,
        /// Bodies of a fighter.
        pub bodies: u32,
        /// Index of the first fighter's torso.
        pub torso: u32,
        /// Index of the first fighter's head.
        pub head: u32,
        /// Index of the first fighter's right hand.
        pub right_hand: u32,
        /// Index of the first fighter's left hand.
        pub left_hand: u32,
        /// How far the torso's centre is up its z axis, m.
        pub torso_up: f32,
        /// How far the head's centre is up its z axis, m.
        pub head_up: f32,
        /// Half the width of the arena, m.
        pub arena: f32,
    }
}

/// Index among them of where the opponent's root is.
pub const OPPONENT: usize = 2;
/// Numbers that are added: of the border 2, of the opponent's root 15, of each fighter's hands 24.
pub const DIM: usize = OPPONENT + 15 + 2 * 24;

/// Queues the shader on `gpu`.
///
/// `poses` is `[bodies * 7][envs]`, `dynamics` as `smooth_dynamics` leaves it, `termination` `[envs]`;
/// `observation` takes rows of `params.width`, from `params.at` on, the fighters of an environment side by side, of
/// each the first [`DIM`] numbers.
pub fn launch(
    gpu: &Gpu,
    poses: &Buffer<f32>,
    dynamics: &Buffer<f32>,
    termination: &Buffer<u32>,
    observation: &Buffer<f32>,
    params: &Params,
) {
    gpu.launch(
        &shader::BOXING_OBSERVE,
        groups(&shader::BOXING_OBSERVE, FIGHTERS * params.envs as usize),
        &[poses, dynamics, termination, observation],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(
    poses: &[f32],
    dynamics: &[f32],
    termination: &[u32],
    observation: &mut [f32],
    params: &Params,
) {
    let envs = params.envs as usize;
    let mut velocities = vec![0.0; 6 * FIGHTERS * params.bodies as usize];
    for env in (0..envs).filter(|&env| params.only >> termination[env] & 1 == 1) {
        let velocities_at = params.velocities_at as usize;
        gather(dynamics, envs, env, velocities_at, &mut velocities);
        let velocities: Vec<Spatial> = velocities.chunks_exact(6).map(spatial).collect();
        let fighters = Fighters {
            bodies: params.fighter_bodies(),
            poses: &poses_of(poses, envs, env),
            velocities: &velocities,
        };
        for me in 0..FIGHTERS {
            let row = FIGHTERS * env + me;
            let out = &mut observation[params.at as usize + row * params.width as usize..];
            observe(&fighters, me, params.arena, out);
        }
    }
}

/// Writes what a fighter observes, [`DIM`] numbers, in an arena of so many metres half its width.
pub fn observe(fighters: &Fighters, me: usize, arena: f32, out: &mut [f32]) {
    let other = 1 - me;
    let heading = fighters.heading(me);
    let turned = |v: Vec3| in_heading_frame(heading, v);
    let [own, opponent] = [me, other].map(|fighter| fighters.root(fighter));
    let [place, opponent_place] = [own, opponent].map(|root| fighters.poses[root]);
    let [speed, opponent_speed] = [own, opponent].map(|root| fighters.velocities[root]);
    let centre = Vec2::from_slice(&turned(-place.position)) / arena;
    let numbers = centre
        .to_array()
        .into_iter()
        .chain(turned(opponent_place.position - place.position))
        .chain(rotation(opponent_place.rotation, heading))
        .chain(turned(opponent_speed.linear - speed.linear))
        .chain(turned(opponent_speed.angular))
        .chain(reach(fighters, me, other, heading))
        .chain(reach(fighters, other, me, heading));
    out.iter_mut()
        .zip(numbers)
        .for_each(|(out, number)| *out = number);
}

/// From every hand of one fighter to what it is to hit of the other: position and velocity, 24 numbers.
fn reach<'a>(
    fighters: &'a Fighters<'a>,
    hitter: usize,
    hit: usize,
    heading: Vec2,
) -> impl Iterator<Item = f32> + 'a {
    let pairs = (0..2).flat_map(|hand| (0..2).map(move |part| (hand, part)));
    pairs.flat_map(move |(hand, part)| {
        let (own, aim) = (fighters.hand(hitter, hand), fighters.target(hit, part));
        let position = in_heading_frame(heading, aim.position - own.position);
        let velocity = in_heading_frame(heading, aim.velocity - own.velocity);
        position.into_iter().chain(velocity)
    })
}

impl Params {
    /// Which body of a fighter is which.
    pub fn fighter_bodies(&self) -> FighterBodies {
        FighterBodies {
            count: self.bodies,
            hands: [self.right_hand, self.left_hand],
            targets: [self.torso, self.head],
            up: [self.torso_up, self.head_up],
        }
    }
}
