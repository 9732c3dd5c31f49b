//! What a boxer does in a clip, as curves of what the body is to do.

use super::curve::Curve;
use super::footing::{Footing, Stance, nearest_foot};
use super::punch::{PunchTarget, ThrownPunch};

/// A step that is taken in a clip.
#[derive(Clone, Copy, Debug)]
pub struct BoxingStep {
    /// When the first foot leaves (s).
    pub from: f32,
    /// When the second foot has landed (s).
    pub to: f32,
    /// Direction against the one faced: 0 forward, positive to the left (rad).
    pub bearing: f32,
    /// Metres; 0 of a pivot about the ball of the left foot.
    pub length: f32,
    /// Change of the direction faced (rad).
    pub turn: f32,
}

/// Direction of the hips and of the shoulders against the heading, in guard (rad).
pub const HIPS_YAW: f32 = -0.5;
pub const CHEST_YAW: f32 = -0.56;
/// Forward lean of the trunk in guard (rad).
const LEAN: f32 = 0.16;
/// Lowering of the hips, and leaning, in punches to the head and to the body (m, rad).
const DIP: (f32, f32) = (0.025, 0.13);
const STOOP: (f32, f32) = (0.11, 0.36);
/// Half of the time that both feet stand between the two halves of a step (s).
const BETWEEN: f32 = 0.02;
/// The trunk tilts that much further over a hook to the body.
const TILT: f32 = 3.0;

/// All that is planned for a clip.
#[derive(Clone, Debug)]
pub struct Choreography {
    /// Direction faced (rad).
    pub heading: Curve,
    /// Direction of hips and shoulders against it (rad).
    pub hips: Curve,
    pub chest: Curve,
    /// Tilt of the trunk, forward and left side up (rad).
    pub lean: Curve,
    pub tilt: Curve,
    /// Lowering of the hips (m).
    pub dip: Curve,
    /// The left foot's share of the weight.
    pub weight: Curve,
    pub feet: [Footing; 2],
    pub punches: Vec<ThrownPunch>,
    pub steps: Vec<BoxingStep>,
    /// Where the last step leads.
    stance: Stance,
}

impl Choreography {
    pub fn in_guard() -> Choreography {
        let stance = Stance::default();
        Choreography {
            heading: Curve::default(),
            hips: Curve::resting_at(HIPS_YAW),
            chest: Curve::resting_at(CHEST_YAW),
            lean: Curve::resting_at(LEAN),
            tilt: Curve::default(),
            dip: Curve::default(),
            weight: Curve::resting_at(0.5),
            feet: [0, 1].map(|side| Footing::standing(&stance, side)),
            punches: Vec::new(),
            steps: Vec::new(),
            stance,
        }
    }

    /// Steps, the nearest foot first; each foot takes `swing` seconds.
    pub fn step(&mut self, from: f32, (bearing, length, turn): (f32, f32, f32), swing: f32) {
        let first = nearest_foot(bearing);
        let to = from + 2.0 * swing;
        self.stance = self.stance.stepped(bearing, length, turn);
        self.swing(first, (from, from + swing - BETWEEN));
        self.swing(1 - first, (from + swing + BETWEEN, to));
        self.heading.go((from, to), turn);
        self.steps.push(BoxingStep {
            from,
            to,
            bearing,
            length,
            turn,
        });
    }

    /// Turns on the ball of the left foot, while the right one swings round.
    pub fn pivot(&mut self, from: f32, turn: f32, seconds: f32) {
        let to = from + seconds;
        let middle = from + 0.5 * seconds;
        self.stance = self.stance.pivoted(0, turn);
        self.swing(1, (from + 0.15 * seconds, from + 0.85 * seconds));
        let left = &mut self.feet[0];
        left.yaw.arrive((from, to), self.stance.foot_yaw(0));
        left.heel.visit((from, middle), (middle, to), 0.12);
        self.heading.go((from, to), turn);
        self.steps.push(BoxingStep {
            from,
            to,
            bearing: 0.0,
            length: 0.0,
            turn,
        });
    }

    fn swing(&mut self, side: usize, span: (f32, f32)) {
        let (ball, yaw) = (self.stance.ball(side), self.stance.foot_yaw(side));
        self.feet[side].swing(span, ball, yaw);
    }

    /// Throws a punch: the hips lead, the shoulders follow, and the fist comes last. The body stays
    /// as it is then until it [recovers](Self::recover) or throws another one.
    pub fn throw(&mut self, punch: ThrownPunch) {
        let effort = punch.kind.effort();
        let (start, apex) = (punch.start, punch.apex());
        let low = punch.target == PunchTarget::Body;
        let of = |(head, body): (f32, f32)| if low { body } else { head };

        let windup = ((start - 0.3, start - 0.08), (start - 0.12, start + 0.12));
        for (curve, by) in [
            (&mut self.hips, effort.hips),
            (&mut self.chest, effort.chest),
        ] {
            curve.visit(windup.0, windup.1, -effort.windup * by);
        }
        self.hips
            .arrive((start - 0.1, apex - 0.03), HIPS_YAW + effort.hips);
        self.chest
            .arrive((start - 0.05, apex), CHEST_YAW + effort.chest);

        let hook_low = low && punch.kind.is_hook();
        let tilt = effort.tilt * if hook_low { TILT } else { 1.0 };
        self.tilt.arrive((start - 0.15, apex), tilt);
        self.lean.arrive((start - 0.2, apex), LEAN + of(STOOP));
        self.dip.arrive((start - 0.25, apex), of(DIP));
        self.weight
            .arrive((start - 0.25, apex), 0.5 + effort.weight);

        let drive = (start - 0.08, apex);
        self.feet[punch.kind.side()].drive(drive, effort.pivot, effort.heel);
        self.feet[1 - punch.kind.side()].drive(drive, 0.0, 0.0);
        self.punches.push(punch);
    }

    /// Returns to guard between two moments, the height of the hips last.
    pub fn recover(&mut self, (from, to): (f32, f32)) {
        self.hips.arrive((from, to + 0.1), HIPS_YAW);
        self.chest.arrive((from, to + 0.05), CHEST_YAW);
        self.tilt.arrive((from, to + 0.15), 0.0);
        self.lean.arrive((from, to + 0.15), LEAN);
        self.dip.arrive((from, to + 0.25), 0.0);
        self.weight.arrive((from, to + 0.2), 0.5);
        for foot in &mut self.feet {
            foot.drive((from, to + 0.15), 0.0, 0.0);
        }
    }
}
