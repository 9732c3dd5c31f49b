//! Motion quality in numbers: foot skate, penetration, jumps, smoothness.

use super::contact::{FootContact, SolePoints};
use super::placed_frame::PlacedFrame;
use super::player::{Feet, Player, Style};
use crate::motion::RATE;
use crate::motion::database::Database;
use crate::motion::skeleton::JointTransforms;
use glam::Vec3;
use serde::Serialize;
use std::sync::Arc;

/// A foot shown so much higher than it was recorded standing is in the air, m.
const AIR: f32 = 0.02;

/// Quality of shown frames, or of the recording between two jumps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Quality {
    /// Fraction of feet that stand on, from one frame to the next; the skate is theirs. A foot that is
    /// lifted to step elsewhere does not stand.
    pub standing: f64,
    /// Ground speed of the bearing point of a standing foot, mean, cm/s.
    pub foot_skate_cm_s: f64,
    /// Depth of the lowest point of a sole below the ground, mean over all frames and most, cm.
    pub penetration_mean_cm: f64,
    /// The greatest depth, cm.
    pub penetration_max_cm: f64,
    /// Distance of the worst joint of a pose to its position had it moved on steadily, cm.
    pub jump_cm: f64,
    /// Mean over all joints, at jumps, m/s^2 and m/s^3.
    pub acceleration: f64,
    /// Jerk, m/s^3.
    pub jerk: f64,
}

/// Quality under each style, and of the recordings themselves.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct QualityComparison {
    /// Shown frames, and how many of them follow a jump.
    pub frames: usize,
    /// Frames that follow a jump.
    pub jumps: usize,
    /// The recordings between two jumps.
    pub recorded: Quality,
    /// Frames as they are found.
    pub raw: Quality,
    /// Blended linearly.
    pub simple: Quality,
    /// Inertialized.
    pub stitched: Quality,
    /// Inertialized, with feet locked.
    pub locked: Quality,
}

/// Evaluates episodes over one database: chains of placed frames, each beginning with the frame before
/// the first that counts.
pub fn compare(database: &Arc<Database>, episodes: &[Vec<PlacedFrame>]) -> QualityComparison {
    use super::stitch::Stitching::{Inertialize, Linear};
    let feet = Arc::new(Feet::of(database));
    let style = |stitching, foot_locking| Style {
        stitching,
        foot_locking,
    };
    let evaluated = |style: Style, at_jumps: bool| {
        let mut sums = Sums::default();
        for episode in episodes {
            sums.add(&play(database, &feet, style, episode), at_jumps);
        }
        sums
    };
    let raw = evaluated(Style::RAW, true);
    QualityComparison {
        frames: raw.frames,
        jumps: raw.jumps,
        recorded: evaluated(Style::RAW, false).quality(),
        raw: raw.quality(),
        simple: evaluated(style(Linear, false), true).quality(),
        stitched: evaluated(style(Inertialize, false), true).quality(),
        locked: evaluated(Style::BEST, true).quality(),
    }
}

/// What is evaluated of a shown frame.
struct Frame {
    joints: Vec<Vec3>,
    soles: [SolePoints; 2],
    contacts: [FootContact; 2],
    /// It does not follow the previous one in the recording.
    jumped: bool,
}

fn play(
    database: &Arc<Database>,
    feet: &Arc<Feet>,
    style: Style,
    episode: &[PlacedFrame],
) -> Vec<Frame> {
    let mut player = Player::new(database.clone(), feet.clone(), style, episode[0]);
    let mut recorded = JointTransforms::default();
    episode
        .windows(2)
        .map(|pair| {
            player.next(pair[1]);
            let soles = feet.soles(player.world());
            pair[1]
                .pose(database)
                .world_into(&database.skeleton, &mut recorded);
            let recorded = feet.soles(&recorded);
            let contacts = [0, 1].map(|side| {
                let contact = feet.contacts[pair[1].frame][side];
                let heights = [soles[side], recorded[side]].map(|sole| sole.point(contact));
                match heights {
                    [Some(shown), Some(recorded)] if shown.y <= recorded.y + AIR => contact,
                    _ => FootContact::Air,
                }
            });
            Frame {
                joints: player.world().positions.clone(),
                soles,
                contacts,
                jumped: pair[1].frame != pair[0].frame + 1,
            }
        })
        .collect()
}

/// Sums over frames.
#[derive(Default)]
struct Sums {
    frames: usize,
    jumps: usize,
    skate: f64,
    standing: usize,
    depth: f64,
    deepest: f64,
    poses: usize,
    jump: f64,
    joints: usize,
    acceleration: f64,
    jerk: f64,
}

impl Sums {
    /// `at_jumps`: speeds are of all frames, accelerations of those around a jump; else both are of
    /// frames with no jump around them.
    fn add(&mut self, frames: &[Frame], at_jumps: bool) {
        self.frames += frames.len();
        self.jumps += frames.iter().filter(|frame| frame.jumped).count();
        for pair in frames.windows(2) {
            if at_jumps || !pair[1].jumped {
                self.feet(&pair[0], &pair[1]);
            }
        }
        for four in frames.windows(4) {
            if four[1..].iter().any(|frame| frame.jumped) == at_jumps {
                self.joints([&four[0], &four[1], &four[2], &four[3]]);
            }
        }
    }

    fn feet(&mut self, before: &Frame, after: &Frame) {
        for side in [0, 1] {
            let (from, to) = (before.soles[side], after.soles[side]);
            let deep = f64::from(-to.heel.y.min(to.toe.y)).max(0.0);
            self.depth += deep;
            self.deepest = self.deepest.max(deep);
            let contact = after.contacts[side];
            if let (true, Some(from), Some(to)) = (
                before.contacts[side] == contact,
                from.point(contact),
                to.point(contact),
            ) {
                self.standing += 1;
                self.skate += f64::from((to.x - from.x).hypot(to.z - from.z));
            }
        }
    }

    fn joints(&mut self, [a, b, c, d]: [&Frame; 4]) {
        let mut worst = 0.0_f64;
        for joint in 0..a.joints.len() {
            let [a, b, c, d] = [a, b, c, d].map(|frame| frame.joints[joint]);
            let strayed = f64::from((d - 2.0 * c + b).length());
            worst = worst.max(strayed);
            self.acceleration += strayed;
            self.jerk += f64::from((d - 3.0 * c + 3.0 * b - a).length());
        }
        self.joints += a.joints.len();
        // Of the jump itself, not of the frames after it.
        if d.jumped || !(b.jumped || c.jumped) {
            self.poses += 1;
            self.jump += worst;
        }
    }

    fn quality(&self) -> Quality {
        let rate = f64::from(RATE);
        let mean = |sum: f64, count: usize| sum / count.max(1) as f64;
        Quality {
            standing: mean(self.standing as f64, 2 * self.frames),
            foot_skate_cm_s: 100.0 * rate * mean(self.skate, self.standing),
            penetration_mean_cm: 100.0 * mean(self.depth, 2 * self.frames),
            penetration_max_cm: 100.0 * self.deepest,
            jump_cm: 100.0 * mean(self.jump, self.poses),
            acceleration: rate.powi(2) * mean(self.acceleration, self.joints),
            jerk: rate.powi(3) * mean(self.jerk, self.joints),
        }
    }
}
