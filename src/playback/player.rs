//! Poses out of a chain of placed frames.

use super::contact::{FootContact, SolePoints, contacts};
use super::foot_lock::FootLock;
use super::leg::{LegJoints, legs};
use super::placed_frame::PlacedFrame;
use super::pose::CharacterPose;
use super::spring::Spring;
use super::stitch::{Stitch, Stitching};
use super::two_bone_ik;
use crate::motion::database::Database;
use crate::motion::skeleton::JointTransforms;
use glam::Vec3;
use std::sync::Arc;

/// Hips come down for a foot by this much at most, m.
const LOWEST: f32 = 0.12;
/// How fast they come down, for a foot that would slide, and how fast they rise again, a frame.
const DOWN: f32 = 3.5;
const RISE: f32 = 0.4;

/// What all players of one database share.
#[derive(Debug)]
pub struct Feet {
    /// Joints and geometry of both legs, left first.
    pub legs: [LegJoints; 2],
    /// Contacts of every frame, left foot first.
    pub contacts: Vec<[FootContact; 2]>,
}

impl Feet {
    /// Legs and contacts of all frames of a database.
    pub fn of(database: &Database) -> Feet {
        let legs = legs(database);
        let contacts = contacts(database, &legs);
        Feet { legs, contacts }
    }

    /// Both soles of a pose, left first.
    pub fn soles(&self, world: &JointTransforms) -> [SolePoints; 2] {
        let JointTransforms {
            positions,
            rotations,
        } = world;
        [0, 1].map(|side| SolePoints::of(&self.legs[side], positions, rotations))
    }
}

/// How jumps and sliding feet are hidden.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Style {
    /// How poses are blended where the frame jumps.
    pub stitching: Stitching,
    /// Whether standing feet are held.
    pub foot_locking: bool,
}

impl Style {
    /// The recorded poses as they are.
    pub const RAW: Style = Style {
        stitching: Stitching::None,
        foot_locking: false,
    };
    /// Inertialization and foot locking.
    pub const BEST: Style = Style {
        stitching: Stitching::Inertialize,
        foot_locking: true,
    };
}

/// Shows one character, frame by frame.
#[derive(Clone)]
pub struct Player {
    database: Arc<Database>,
    feet: Arc<Feet>,
    style: Style,
    shown: PlacedFrame,
    stitch: Stitch,
    locks: [FootLock; 2],
    /// Distance by which the hips are lowered, m.
    hips: Spring,
    pose: CharacterPose,
    /// The pose's joints.
    world: JointTransforms,
}

impl Player {
    /// A character that begins after `shown`.
    pub fn new(database: Arc<Database>, feet: Arc<Feet>, style: Style, shown: PlacedFrame) -> Self {
        let stitch = Stitch::new(style.stitching, database.skeleton.joints());
        let pose = shown.pose(&database);
        let mut world = JointTransforms::default();
        pose.world_into(&database.skeleton, &mut world);
        Player {
            pose,
            world,
            database,
            feet,
            style,
            shown,
            stitch,
            locks: Default::default(),
            hips: Spring::default(),
        }
    }

    /// Goes on with the same motion in another place, where there may be more of it.
    pub fn set_database(&mut self, database: &Arc<Database>, feet: &Arc<Feet>) {
        (self.database, self.feet) = (database.clone(), feet.clone());
    }

    /// The pose of the next frame: of the same clip, or of wherever a match has jumped to.
    pub fn next(&mut self, shown: PlacedFrame) -> &CharacterPose {
        self.stitch.advance();
        if shown.frame != self.shown.frame + 1 {
            self.stitch.begin(&self.database, self.shown, shown);
        }
        self.shown = shown;
        shown.pose_into(&self.database, &mut self.pose);
        self.transform();
        let recorded = self.feet.soles(&self.world);
        self.stitch.apply(&mut self.pose);
        self.transform();
        if self.style.foot_locking {
            self.lock(&recorded);
            self.transform();
        }
        &self.pose
    }

    /// The last pose.
    pub fn pose(&self) -> &CharacterPose {
        &self.pose
    }

    /// The joints of the last pose in the world.
    pub fn world(&self) -> &JointTransforms {
        &self.world
    }

    fn transform(&mut self) {
        let skeleton = &self.database.skeleton;
        self.pose.world_into(skeleton, &mut self.world);
    }

    /// Holds the standing feet, and keeps both above the ground; where a leg is too short for that, the
    /// hips come down.
    fn lock(&mut self, recorded: &[SolePoints; 2]) {
        let (skeleton, pose) = (&self.database.skeleton, &mut self.pose);
        let JointTransforms {
            positions,
            rotations,
        } = &self.world;
        let mut targets = [Vec3::ZERO; 2];
        let mut shortfall = 0.0_f32;
        for (side, leg) in self.feet.legs.iter().enumerate() {
            let sole = SolePoints::of(leg, positions, rotations);
            let contact = self.feet.contacts[self.shown.frame][side];
            let held = self.locks[side].next(&sole, &recorded[side], contact);
            let sunk = -held.y - sole.heel.y.min(sole.toe.y);
            let foot = positions[leg.foot];
            targets[side] = foot + held + Vec3::Y * sunk.max(0.0);
            if contact != FootContact::Air {
                let length = skeleton.reach(leg.hip, leg.foot);
                let leg_shortfall =
                    two_bone_ik::shortfall(positions[leg.hip], foot, targets[side], length);
                shortfall = shortfall.max(leg_shortfall.unwrap_or(0.0).min(LOWEST));
            }
        }
        let rate = if shortfall > self.hips.position {
            DOWN
        } else {
            RISE
        };
        pose.root.y -= self.hips.follow(shortfall, rate);
        for (leg, target) in self.feet.legs.iter().zip(targets) {
            two_bone_ik::solve(skeleton, pose, leg, target, &mut self.world);
        }
    }
}
