//! A database frame, placed in the world.

use super::pose::CharacterPose;
use crate::motion::character_frame::{to_local, to_world};
use crate::motion::database::Database;
use crate::motion::features::{POSE_DIM, ROW_STRIDE, TRAJECTORY_OFFSETS};
use glam::{Quat, Vec3};

/// A database frame and its character frame in the world: everything that motion
/// matching knows of a character.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedFrame {
    /// Frame of the database.
    pub frame: usize,
    /// Ground point, `[x, z]`, m.
    pub at: [f32; 2],
    /// Unit forward direction, `[x, z]`.
    pub heading: [f32; 2],
}

impl PlacedFrame {
    /// This character so many frames later (or earlier), moving as recorded. The clip's ends stop it.
    pub fn on(self, database: &Database, frames: isize) -> PlacedFrame {
        let clip = database.clip(self.frame);
        let last = clip.first + clip.frames - 1;
        let frame = self.frame.saturating_add_signed(frames);
        let frame = frame.clamp(clip.first, last);
        let ([x, z, hx, hz], then) = (database.path[self.frame], database.path[frame]);
        let moved = to_local([then[0] - x, then[1] - z], [hx, hz]);
        let moved = to_world(moved, self.heading);
        let [turned_x, turned_z] = to_world(to_local([then[2], then[3]], [hx, hz]), self.heading);
        let length = turned_x.hypot(turned_z);
        PlacedFrame {
            frame,
            at: [self.at[0] + moved[0], self.at[1] + moved[1]],
            heading: [turned_x / length, turned_z / length],
        }
    }

    /// The trajectory that a normalised query requests from here, in the world: x, z (m), heading x, heading z.
    pub fn requested(
        self,
        database: &Database,
        query: &[f32; ROW_STRIDE],
    ) -> [[f32; 4]; TRAJECTORY_OFFSETS.len()] {
        let normal = &database.normalisation;
        let value = |i: usize| query[i] / normal.scale[i] + normal.mean[i];
        std::array::from_fn(|k| {
            let [x, z, hx, hz] = std::array::from_fn(|i| value(POSE_DIM + 4 * k + i));
            let (moved, turned) = (
                to_world([x, z], self.heading),
                to_world([hx, hz], self.heading),
            );
            let length = turned[0].hypot(turned[1]).max(1e-6);
            [
                self.at[0] + moved[0],
                self.at[1] + moved[1],
                turned[0] / length,
                turned[1] / length,
            ]
        })
    }

    /// The recorded trajectory at the offsets of the trajectory feature: x, z (m), heading x, heading z.
    pub fn path(self, database: &Database) -> [[f32; 4]; TRAJECTORY_OFFSETS.len()] {
        TRAJECTORY_OFFSETS.map(|ahead| {
            let then = self.on(database, ahead as isize);
            [then.at[0], then.at[1], then.heading[0], then.heading[1]]
        })
    }

    /// The recorded pose, placed here.
    pub fn pose(self, database: &Database) -> CharacterPose {
        let mut pose = CharacterPose::default();
        self.pose_into(database, &mut pose);
        pose
    }

    /// [`PlacedFrame::pose`] in memory that is there already.
    pub fn pose_into(self, database: &Database, pose: &mut CharacterPose) {
        let root = self.root(database);
        pose.root = root.position;
        pose.rotations.clear();
        pose.rotations
            .extend_from_slice(recorded(database, self.frame));
        pose.rotations[0] = root.rotation;
    }

    /// The recorded root, placed here.
    pub fn root(self, database: &Database) -> PlacedRoot {
        let [x, z, hx, hz] = database.path[self.frame];
        let rotation = Quat::from_rotation_y(yaw(self.heading) - yaw([hx, hz]));
        let ground = Vec3::new(self.at[0], 0.0, self.at[1]);
        PlacedRoot {
            position: ground + rotation * (database.hips[self.frame] - Vec3::new(x, 0.0, z)),
            rotation: (rotation * recorded(database, self.frame)[0]).normalize(),
        }
    }
}

/// The root joint in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedRoot {
    /// Position, m.
    pub position: Vec3,
    /// Rotation.
    pub rotation: Quat,
}

/// The recorded rotations of a frame.
pub fn recorded(database: &Database, frame: usize) -> &[Quat] {
    let joints = database.skeleton.joints();
    &database.rotations[frame * joints..][..joints]
}

/// The angle about the vertical that takes +z to `heading`.
fn yaw(heading: [f32; 2]) -> f32 {
    heading[0].atan2(heading[1])
}
