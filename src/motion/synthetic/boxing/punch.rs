//! The punches, and what each does to the body.

/// Which punch an orthodox boxer, left side ahead, throws.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PunchKind {
    /// Straight, with the leading left.
    Jab,
    /// Straight, with the right behind it.
    Cross,
    /// Round, with the left.
    LeftHook,
    /// Round, with the right.
    RightHook,
}

/// What a punch is meant for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PunchTarget {
    /// Somebody's head.
    Head,
    /// Somebody's body: the knees and the trunk bend.
    Body,
}

/// A punch that is thrown in a clip.
#[derive(Clone, Copy, Debug)]
pub struct ThrownPunch {
    /// Which.
    pub kind: PunchKind,
    /// At what.
    pub target: PunchTarget,
    /// When the fist sets off (s).
    pub start: f32,
    /// Seconds that the fist takes to get there.
    pub out: f32,
    /// Seconds that it takes to come back to the guard.
    pub back: f32,
    /// Height of what is punched (m).
    pub(super) height: f32,
    /// To which side it lies of straight ahead: positive to the left (m).
    pub(super) aside: f32,
    /// The share of its length to which the arm stretches (straights), or how far ahead of the
    /// neck the fist gets in metres (hooks).
    pub(super) reach: f32,
}

/// Seconds that a fist stays at the end of its way.
pub const HOLD: f32 = 0.03;

impl PunchKind {
    /// All of them.
    pub const ALL: [PunchKind; 4] = [
        PunchKind::Jab,
        PunchKind::Cross,
        PunchKind::LeftHook,
        PunchKind::RightHook,
    ];

    /// 0 left, 1 right.
    pub fn side(self) -> usize {
        match self {
            PunchKind::Jab | PunchKind::LeftHook => 0,
            PunchKind::Cross | PunchKind::RightHook => 1,
        }
    }

    /// Whether the fist flies round, not straight.
    pub fn is_hook(self) -> bool {
        matches!(self, PunchKind::LeftHook | PunchKind::RightHook)
    }

    pub(super) fn effort(self) -> Effort {
        match self {
            PunchKind::Jab => Effort {
                hips: -0.2,
                chest: -0.55,
                windup: 0.05,
                tilt: 0.0,
                weight: 0.15,
                pivot: 0.0,
                heel: 0.0,
            },
            PunchKind::Cross => Effort {
                hips: 0.85,
                chest: 1.45,
                windup: 0.1,
                tilt: 0.03,
                weight: 0.2,
                pivot: 0.75,
                heel: 0.42,
            },
            PunchKind::LeftHook => Effort {
                hips: -0.6,
                chest: -1.05,
                windup: 0.5,
                tilt: -0.04,
                weight: -0.1,
                pivot: -0.55,
                heel: 0.2,
            },
            PunchKind::RightHook => Effort {
                hips: 0.65,
                chest: 1.05,
                windup: 0.15,
                tilt: 0.05,
                weight: 0.12,
                pivot: 0.7,
                heel: 0.38,
            },
        }
    }
}

/// What a punch asks of the body.
pub struct Effort {
    /// Turning of the hips and of the shoulders with it (rad, positive to the left).
    pub hips: f32,
    pub chest: f32,
    /// How much of that they turn the other way before, as a share.
    pub windup: f32,
    /// Tilting of the trunk, left side up (rad).
    pub tilt: f32,
    /// Weight that moves to the left foot, as a share.
    pub weight: f32,
    /// Turning of the foot of the same side on its ball, and lifting of its heel (rad).
    pub pivot: f32,
    pub heel: f32,
}

impl ThrownPunch {
    /// When the fist has got there (s).
    pub fn apex(&self) -> f32 {
        self.start + self.out
    }

    /// When the fist begins to return (s).
    pub fn turn(&self) -> f32 {
        self.apex() + HOLD
    }

    /// When the fist is back in guard (s).
    pub fn end(&self) -> f32 {
        self.turn() + self.back
    }
}
