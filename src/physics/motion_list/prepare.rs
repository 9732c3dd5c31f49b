//! One recording of a list, in the body.

use super::error::UnusableClip;
use super::folder::is_text;
use super::listed::ListedClip;
use super::options::MotionListOptions;
use crate::motion::import::import_file;
use crate::physics::deepmimic;
use crate::physics::drive::rotation_vector;
use crate::physics::footing::{Footing, floor, percentile};
use crate::physics::kinematics::quaternion;
use crate::physics::mirror::mirrored;
use crate::physics::model::{Joint, JointKind, Model};
use crate::physics::motion_clip::MotionClip;
use crate::physics::retarget::{RetargetError, footing, retarget};

/// Feet may stand no further above or below the ground, m.
const FEET_OFF: f32 = 0.1;

/// A joint that is this close to its limit has been stopped by it, rad.
const AT_LIMIT: f32 = 1e-3;

/// The low and the high figure of a report.
const PERCENTILES: [f32; 2] = [0.05, 0.95];

type Result<T> = std::result::Result<T, UnusableClip>;

/// A recording in the body, and what was measured on it; for the figures see
/// [`ClipReport`](super::ClipReport).
pub struct Prepared {
    /// Its motion and, if there is to be one, its mirrored copy.
    pub motions: Vec<MotionClip>,
    pub foot_height: [f32; 2],
    pub floor: [f32; 2],
    pub grounded: bool,
    pub limits_hit: f32,
    pub t_pose_frames: usize,
    pub notes: Vec<String>,
}

impl Prepared {
    pub fn seconds(&self) -> f32 {
        self.motions[0].seconds()
    }
}

pub fn prepare(
    listed: &ListedClip,
    model: &Model,
    options: &MotionListOptions,
) -> Result<Prepared> {
    let whole = read(listed, model, options)?;
    let footing = footing(model).map_err(|error| not_put(&whole.motion.name, error))?;
    let motion = match listed.span {
        [None, None] => whole.motion,
        span => cut(&whole.motion, span, model, &footing)?,
    };
    check_length(&motion.name, motion.frames, options)?;
    let off = off_ground(&motion, &footing);
    if let Some(floor) = off.filter(|_| !listed.ground.unwrap_or(options.ground)) {
        return Err(UnusableClip::Feet {
            clip: motion.name,
            floor,
            most: FEET_OFF,
        });
    }
    let grounded = off.is_some() || listed.ground == Some(true);
    let motion = match grounded {
        true => ground(&motion, model, &footing),
        false => motion,
    };
    let heights = footing.heights(&motion.q);
    let copy = match listed.mirror.unwrap_or(options.import.mirror) {
        true => Some(mirror(model, &motion)?),
        false => None,
    };
    Ok(Prepared {
        floor: low_and_high(floor(&heights, motion.rate)),
        foot_height: low_and_high(heights),
        grounded,
        limits_hit: limits_hit(model, &motion),
        t_pose_frames: whole.t_pose_frames,
        notes: whole.notes,
        motions: std::iter::once(motion).chain(copy).collect(),
    })
}

/// All of a recording in the body.
struct Whole {
    motion: MotionClip,
    t_pose_frames: usize,
    notes: Vec<String>,
}

fn read(listed: &ListedClip, model: &Model, options: &MotionListOptions) -> Result<Whole> {
    if is_text(&listed.file) {
        return Ok(Whole {
            motion: deepmimic::read(&listed.file, model)?,
            t_pose_frames: 0,
            notes: Vec::new(),
        });
    }
    let import = import_file(&listed.file, &options.import)?;
    let clip = &import.clip;
    check_length(&clip.name, clip.frames(), options)?;
    let motion = retarget(clip, &import.roles, model).map_err(|e| not_put(&clip.name, e))?;
    Ok(Whole {
        motion,
        t_pose_frames: import.t_pose_frames,
        notes: import.notes,
    })
}

fn not_put(clip: &str, error: RetargetError) -> UnusableClip {
    UnusableClip::Retarget {
        clip: clip.to_string(),
        error,
    }
}

fn check_length(clip: &str, frames: usize, options: &MotionListOptions) -> Result<()> {
    match frames >= options.needed() {
        true => Ok(()),
        false => Err(UnusableClip::Short {
            clip: clip.to_string(),
            frames,
            needed: options.needed(),
        }),
    }
}

/// A span of a motion, which begins above the origin and stands on the ground like a whole one.
fn cut(
    motion: &MotionClip,
    span: [Option<f32>; 2],
    model: &Model,
    footing: &Footing,
) -> Result<MotionClip> {
    let seconds = motion.seconds();
    let [start, end] = [span[0].unwrap_or(0.0), span[1].unwrap_or(seconds)];
    let last = (end * motion.rate).round();
    if !(0.0 <= start && start < end && last < motion.frames as f32) {
        return Err(UnusableClip::Span {
            clip: motion.name.clone(),
            start,
            end,
            seconds,
        });
    }
    let (first, last) = ((start * motion.rate).round() as usize, last as usize);
    let mut q = motion.q[first * model.nq()..(last + 1) * model.nq()].to_vec();
    footing.stand(&mut q);
    footing.begin_at_origin(&mut q);
    Ok(MotionClip::new(&motion.name, model, motion.rate, q))
}

/// The heights at which the feet stand, if these are not the ground's.
fn off_ground(motion: &MotionClip, footing: &Footing) -> Option<[f32; 2]> {
    let [low, high] = low_and_high(floor(&footing.heights(&motion.q), motion.rate));
    (low < -FEET_OFF || high > FEET_OFF).then_some([low, high])
}

/// A motion with its feet on the ground wherever they stand.
fn ground(motion: &MotionClip, model: &Model, footing: &Footing) -> MotionClip {
    let mut q = motion.q.clone();
    footing.ground(&mut q, motion.rate);
    footing.stand(&mut q);
    MotionClip::new(&motion.name, model, motion.rate, q)
}

fn mirror(model: &Model, motion: &MotionClip) -> Result<MotionClip> {
    let copy = mirrored(model, motion)?;
    Ok(MotionClip {
        name: format!("{} mirrored", motion.name),
        ..copy
    })
}

fn low_and_high(mut values: Vec<f32>) -> [f32; 2] {
    PERCENTILES.map(|share| percentile(&mut values, share))
}

/// Fraction of the frames in which a joint is at a limit.
fn limits_hit(model: &Model, motion: &MotionClip) -> f32 {
    let hit = |&frame: &usize| {
        let q = motion.q(frame);
        model
            .joints
            .iter()
            .any(|joint| at_limit(joint, &q[joint.q..]))
    };
    (0..motion.frames).filter(hit).count() as f32 / motion.frames as f32
}

/// Whether a joint is at a limit. Zero is none: limbs are straight there.
fn at_limit(joint: &Joint, q: &[f32]) -> bool {
    let angle = match joint.kind {
        JointKind::Hinge => q[0],
        JointKind::Ball => rotation_vector(quaternion(q)).length(),
        JointKind::Free => return false,
    };
    let ends = joint.range.into_iter().flatten();
    let mut ends = ends.filter(|end| end.abs() > AT_LIMIT);
    ends.any(|end| (angle - end).abs() < AT_LIMIT)
}
