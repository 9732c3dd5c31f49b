//! What is decided for all recordings of a folder together.

use super::options::ImportOptions;
use super::subject::Subject;
use crate::motion::error::{MotionError, MotionResult};
use crate::motion::skeleton::Skeleton;
use crate::motion::units;
use crate::motion::up::{UpAxis, UpEvidence};

/// What recordings of one folder have in common.
pub struct FolderEvidence {
    up: Option<UpAxis>,
    unit_m: Option<f32>,
    units_differ: bool,
}

/// How one recording is to be read.
pub struct ClipReading {
    pub up: UpAxis,
    pub unit_m: f32,
    /// Whether nobody gave the unit.
    pub unit_found: bool,
    /// Whether others of the folder have another unit.
    pub units_differ: bool,
}

impl FolderEvidence {
    pub fn of(subjects: &[&Subject], options: &ImportOptions) -> FolderEvidence {
        let votes = |axis: UpAxis| {
            let standing = subjects
                .iter()
                .filter(|s| s.stance == UpEvidence::Stands(axis));
            standing.count()
        };
        let axes = UpAxis::ALL.into_iter().filter(|&axis| votes(axis) > 0);
        // The first of equals.
        let up = axes.reduce(|best, axis| {
            if votes(axis) > votes(best) {
                axis
            } else {
                best
            }
        });
        let legs = subjects
            .iter()
            .filter(|subject| given_unit(subject, options).is_none());
        let legs: Vec<(f32, f32)> = legs
            .filter_map(|subject| Some((subject.leg, own_unit(subject).ok()?)))
            .collect();
        let unit_m = units::common(&legs);
        FolderEvidence {
            up,
            unit_m,
            units_differ: unit_m.is_none() && !legs.is_empty(),
        }
    }

    /// # Errors
    /// It is unclear which way is up, or the unit is.
    pub fn reading(&self, subject: &Subject, options: &ImportOptions) -> MotionResult<ClipReading> {
        let up = match options.up {
            Some(up) => up,
            None => self
                .up(subject)
                .map_err(|error| error.within(&subject.file))?,
        };
        let given = given_unit(subject, options);
        let unit_m = match given.or(self.unit_m) {
            Some(unit) => unit,
            None => own_unit(subject).map_err(|error| error.within(&subject.file))?,
        };
        let body = &subject.body;
        units::check(unit_m, &body.recording.skeleton, &body.roles)
            .map_err(|error| error.within(&subject.file))?;
        Ok(ClipReading {
            up,
            unit_m,
            unit_found: given.is_none(),
            units_differ: given.is_none() && self.units_differ,
        })
    }

    fn up(&self, subject: &Subject) -> MotionResult<UpAxis> {
        match (subject.stance, self.up) {
            (UpEvidence::Stands(axis), _) | (_, Some(axis)) => Ok(axis),
            (UpEvidence::Unclear, None) => Ok(UpAxis::Y),
            (UpEvidence::StandsOrLies(axis, share), None) => Err(MotionError::Up {
                problem: format!(
                    "in {:.0} % of the frames shoulders and feet lie along {}, so this is a person who stands, \
                     with {} up, or one who lies, with y up",
                    100.0 * share,
                    axis.name(),
                    axis.name()
                ),
            }),
        }
    }
}

fn given_unit(subject: &Subject, options: &ImportOptions) -> Option<f32> {
    let listed = subject.entry.as_ref().and_then(|entry| entry.unit_m);
    options.unit_m.or(listed)
}

fn own_unit(subject: &Subject) -> MotionResult<f32> {
    units::find(&subject.body.recording.skeleton, &subject.body.roles)
}

/// The subject whose tree of joints most others have too; the first of equals.
pub fn usual<'a>(subjects: &[&'a Subject]) -> Option<&'a Subject> {
    let mut trees: Vec<(&Subject, usize)> = Vec::new();
    for subject in subjects {
        let skeleton = &subject.body.recording.skeleton;
        let known = trees
            .iter_mut()
            .find(|(tree, _)| tree.body.recording.skeleton.same_tree(skeleton));
        match known {
            Some((_, count)) => *count += 1,
            None => trees.push((subject, 1)),
        }
    }
    let trees = trees.into_iter();
    trees
        .reduce(|best, tree| if tree.1 > best.1 { tree } else { best })
        .map(|(tree, _)| tree)
}

/// Refuses a subject whose joints are not those of the usual one.
pub fn check_tree(subject: &Subject, usual: &Subject) -> MotionResult<()> {
    let [skeleton, other] = [subject, usual].map(|subject| &subject.body.recording.skeleton);
    if skeleton.same_tree(other) {
        return Ok(());
    }
    let mut pair = [usual, subject];
    pair.sort_by(|a, b| a.file.cmp(&b.file));
    let [first, second] = pair;
    Err(MotionError::Skeletons {
        difference: difference(
            &first.body.recording.skeleton,
            &second.body.recording.skeleton,
        ),
        first: first.file.clone(),
        second: second.file.clone(),
    })
}

/// The first joint in which two trees differ, in words.
fn difference(a: &Skeleton, b: &Skeleton) -> String {
    let parent = |s: &Skeleton, joint: usize| match s.parents[joint] {
        Some(parent) => format!("under '{}'", s.names[parent]),
        None => "at the root".to_string(),
    };
    let place = |s: &Skeleton, joint| format!("'{}' {}", s.names[joint], parent(s, joint));
    let common = a.joints().min(b.joints());
    (0..common)
        .map(|joint| (joint, place(a, joint), place(b, joint)))
        .find(|(_, a, b)| a != b)
        .map(|(joint, a, b)| format!("first in joint {}: {a} against {b}", joint + 1))
        .unwrap_or_else(|| format!("{} joints against {}", a.joints(), b.joints()))
}
