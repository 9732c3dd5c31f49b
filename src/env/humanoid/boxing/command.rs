//! Commands to a fighter. A policy obeys them because it is shown a world in which they are what it would do anyhow:
//! one whose opponent, or whose target, stands where it is to go.

use crate::env::humanoid::task::{CpuHumanoidEnv, agents};
use crate::kernels::humanoid::fighters::FIGHTERS;
use crate::kernels::physics::proprioception::{heading_of, unit};
use crate::physics::kinematics::{quaternion, store};
use glam::{Quat, Vec2};

/// How far ahead of a fighter stands what it is to walk to, m: so far that nobody who has learned to box would stop.
const AHEAD: f32 = 2.0;
/// Distance of an opponent in front of whom fighters stand on guard, m.
const GUARD: f32 = 1.2;

/// What a fighter is told to do. Directions are unit vectors on the ground, of the world.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FightCommand {
    /// Where to walk, if it is to.
    pub walk: Option<Vec2>,
    /// Which way to face; to the opponent, if that is not said.
    pub face: Option<Vec2>,
    /// Whether to attack the opponent.
    pub punch: bool,
}

/// The world as the first fighter is to see it: with an opponent, or a target to topple, that is where the command
/// needs it.
pub struct ImaginedWorld {
    env: CpuHumanoidEnv,
}

impl ImaginedWorld {
    /// In an environment of the task that the fighter's policy has learned.
    pub fn new(env: CpuHumanoidEnv) -> ImaginedWorld {
        ImaginedWorld { env }
    }

    /// What a fighter observes under a command, `[observation]`, in a bout with positions `q` and velocities `v`.
    pub fn observe(&mut self, command: &FightCommand, q: &[f32], v: &[f32]) -> &[f32] {
        let model = self.env.task().model().clone();
        let (own_q, own_v) = (q.len() / FIGHTERS, v.len() / FIGHTERS);
        let aim = Aim::new(command, q);
        let world = &mut self.env.batch.worlds[0].state;
        world.q[..own_q].copy_from_slice(&q[..own_q]);
        world.v[..own_v].copy_from_slice(&v[..own_v]);
        if command.punch && agents(&model) == FIGHTERS {
            world.q.copy_from_slice(q);
            world.v.copy_from_slice(v);
        } else {
            let other = &mut world.q[own_q..];
            other.copy_from_slice(&model.qpos0[own_q..]);
            other[..2].copy_from_slice(&aim.at.to_array());
            let towards = -aim.way;
            let turned = Quat::from_rotation_z(towards.y.atan2(towards.x));
            store(&mut other[3..], turned);
            world.v[own_v..].fill(0.0);
        }
        self.env.steer(0, aim.way, aim.face);
        self.env.observe_all();
        self.env.seen(0)
    }
}

/// Where a command sends a fighter.
struct Aim {
    /// Where what it goes to stands, m.
    at: Vec2,
    /// The direction there.
    way: Vec2,
    face: Vec2,
}

impl Aim {
    fn new(command: &FightCommand, q: &[f32]) -> Aim {
        let [own, opponent] = [0, 1].map(|fighter| Vec2::from_slice(&q[fighter * q.len() / 2..]));
        let to_opponent = unit(opponent - own);
        let face = command.face.unwrap_or(to_opponent);
        let (way, far) = match (command.punch, command.walk) {
            (true, _) => (to_opponent, own.distance(opponent)),
            (false, Some(walk)) => (walk, AHEAD),
            (false, None) => (face, GUARD),
        };
        Aim {
            at: own + far * way,
            way,
            face,
        }
    }
}

/// Which way the first fighter of a bout faces, a unit vector on the ground.
pub fn facing(q: &[f32]) -> Vec2 {
    heading_of(quaternion(&q[3..]))
}
