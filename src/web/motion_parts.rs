//! A database in parts, quantised: the page plays with those that have arrived.
//!
//! A part holds so many frames that follow each other, of one clip or of several: features, path, hips, rotations and
//! foot contacts. The frames of all parts up to one are a database of their own, in which the last clip ends early.
//! Later parts add frames and candidates behind those that are there, whose numbers stay.

use super::quantise::{QuantisedColumns, quantise_rotation, rotation};
use crate::container::{Format, Section, SectionError, Sections, StoreError};
use crate::motion::database::{ClipRecord, Database, candidates, root_motion};
use crate::motion::features::{FEATURE_DIM, MIN_FUTURE_FRAMES, ROW_STRIDE};
use crate::motion::findings::ClipFindings;
use crate::motion::normalise::{Normalisation, Weights};
use crate::motion::roles::Roles;
use crate::motion::skeleton::Skeleton;
use crate::playback::contact::FootContact;
use crate::playback::leg::LegJoints;
use crate::playback::player::Feet;
use glam::{Quat, Vec3};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Bytes of a part.
const PART_BYTES: usize = 1 << 19;
/// Columns of the path: x, z (m), heading x, heading z; and of the hips, m.
const PATH: usize = 4;
const HIPS: usize = 3;

const FORMAT: Format = Format {
    kind: "webpart",
    version: 1,
};

/// What must be known of a database before its first part is there.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct MotionHeader {
    skeleton: Skeleton,
    roles: Roles,
    /// In the order of their frames.
    clips: Vec<ClipRecord>,
    weights: Weights,
    normalisation: Normalisation,
    legs: [LegJoints; 2],
    /// Of all parts together.
    pub frames: usize,
    /// Frames of every part but the last.
    pub part_frames: usize,
    /// The database's own.
    fingerprint: u32,
}

impl MotionHeader {
    /// Cuts a database into parts, its clips in this `order`. The parts come as files.
    ///
    /// # Errors
    /// None: parts have a JSON form.
    pub fn cut(
        database: &Database,
        feet: &Feet,
        order: &[usize],
    ) -> Result<(MotionHeader, Vec<Vec<u8>>), StoreError> {
        let mut frames = Vec::with_capacity(database.frames());
        let mut clips = Vec::with_capacity(order.len());
        for &clip in order {
            let record = &database.clips[clip];
            clips.push(ClipRecord {
                first: frames.len(),
                findings: ClipFindings::default(),
                ..record.clone()
            });
            frames.extend(record.first..record.first + record.frames);
        }
        let joints = database.skeleton.joints();
        let words = FEATURE_DIM + PATH + HIPS + 3 * joints;
        let header = MotionHeader {
            skeleton: database.skeleton.clone(),
            roles: database.roles,
            clips,
            weights: database.weights,
            normalisation: database.normalisation.clone(),
            legs: feet.legs.clone(),
            frames: frames.len(),
            part_frames: (PART_BYTES / (2 * words + size_of::<u32>())).max(2 * MIN_FUTURE_FRAMES),
            fingerprint: database.fingerprint,
        };
        let parts = frames.chunks(header.part_frames);
        let parts =
            parts.map(|frames| part(database, feet, frames).to_bytes(Path::new("part"), FORMAT));
        Ok((header, parts.collect::<Result<_, _>>()?))
    }

    /// Number of parts.
    pub fn parts(&self) -> usize {
        self.frames.div_ceil(self.part_frames)
    }

    /// The motion before the first part.
    pub fn empty(&self) -> (Database, Feet) {
        let database = Database {
            skeleton: self.skeleton.clone(),
            roles: self.roles,
            clips: Vec::new(),
            weights: self.weights,
            normalisation: self.normalisation.clone(),
            features: Vec::new(),
            path: Vec::new(),
            hips: Vec::new(),
            rotations: Vec::new(),
            candidates: Vec::new(),
            motion: Vec::new(),
            fingerprint: self.fingerprint,
        };
        let feet = Feet {
            legs: self.legs.clone(),
            contacts: Vec::new(),
        };
        (database, feet)
    }

    /// Adds the next part, the contents of its file `name`.
    ///
    /// # Errors
    /// It is damaged, or not the next one.
    pub fn append(
        &self,
        database: &mut Database,
        feet: &mut Feet,
        name: &str,
        bytes: &[u8],
    ) -> Result<(), StoreError> {
        let path = Path::new(name);
        let mut sections = Sections::from_bytes(path, bytes, FORMAT)?;
        let before = database.frames();
        if before == 0 {
            self.reserve(database, feet);
        }
        let count = self.part_frames.min(self.frames - before.min(self.frames));
        let mut add = || add_frames(&mut sections.take("frames")?, count, database, feet);
        add().map_err(|SectionError(why)| StoreError::Damaged {
            path: path.to_path_buf(),
            why,
        })?;
        self.join_clips(database);
        Ok(())
    }

    /// Makes room for all parts: growing by and by would take twice as much.
    fn reserve(&self, database: &mut Database, feet: &mut Feet) {
        database.features.reserve_exact(self.frames);
        database.path.reserve_exact(self.frames);
        database.hips.reserve_exact(self.frames);
        let joints = self.skeleton.joints();
        database.rotations.reserve_exact(self.frames * joints);
        feet.contacts.reserve_exact(self.frames);
    }

    /// Makes clips and candidates of the frames that are there.
    fn join_clips(&self, database: &mut Database) {
        let end = database.frames();
        let there = self
            .clips
            .iter()
            .filter(|clip| clip.first + MIN_FUTURE_FRAMES < end);
        let cut = there.map(|clip| ClipRecord {
            frames: clip.frames.min(end - clip.first),
            ..clip.clone()
        });
        database.clips = cut.filter(|clip| clip.frames > MIN_FUTURE_FRAMES).collect();
        let known = database.candidates.len();
        database.candidates = candidates(&database.clips);
        let new = database.candidates[known..].iter();
        let motion = new.map(|&frame| root_motion(&database.path, frame as usize));
        database.motion.extend(motion);
    }
}

/// The frames of a part.
fn part(database: &Database, feet: &Feet, frames: &[usize]) -> Sections {
    let joints = database.skeleton.joints();
    let columns = |width: usize, row: &dyn Fn(usize) -> Vec<f32>| {
        let values: Vec<f32> = frames.iter().flat_map(|&frame| row(frame)).collect();
        QuantisedColumns::of(&values, width)
    };
    let rotations = frames
        .iter()
        .flat_map(|&frame| &database.rotations[frame * joints..][..joints]);
    let rotations: Vec<u16> = rotations
        .flat_map(|&turn| quantise_rotation(turn))
        .collect();
    let contacts = frames.iter().map(|&frame| feet.contacts[frame]);
    let contacts: Vec<u32> = contacts
        .map(|[left, right]| code(left) | code(right) << 2)
        .collect();
    let mut section = Section::default();
    let features = columns(FEATURE_DIM, &|frame| {
        database.features[frame][..FEATURE_DIM].to_vec()
    });
    put_columns(&mut section, "features", &features);
    put_columns(
        &mut section,
        "path",
        &columns(PATH, &|frame| database.path[frame].to_vec()),
    );
    put_columns(
        &mut section,
        "hips",
        &columns(HIPS, &|frame| database.hips[frame].to_array().to_vec()),
    );
    section.put_array("rotations", &even(rotations));
    section.put_array("contacts", &contacts);
    let mut sections = Sections::default();
    sections.put("frames", section);
    sections
}

fn add_frames(
    section: &mut Section,
    count: usize,
    database: &mut Database,
    feet: &mut Feet,
) -> Result<(), SectionError> {
    let joints = database.skeleton.joints();
    let features = take_columns(section, "features", FEATURE_DIM, count)?;
    let path = take_columns(section, "path", PATH, count)?;
    let hips = take_columns(section, "hips", HIPS, count)?;
    let rotations: Vec<u16> =
        section.take_array("rotations", (3 * joints * count).next_multiple_of(2))?;
    let contacts: Vec<u32> = section.take_array("contacts", count)?;
    database
        .features
        .extend(features.chunks_exact(FEATURE_DIM).map(|row| {
            let mut padded = [0.0; ROW_STRIDE];
            padded[..FEATURE_DIM].copy_from_slice(row);
            padded
        }));
    database.path.extend(path.chunks_exact(PATH).map(|row| {
        let length = row[2].hypot(row[3]).max(f32::MIN_POSITIVE);
        [row[0], row[1], row[2] / length, row[3] / length]
    }));
    database
        .hips
        .extend(hips.chunks_exact(HIPS).map(Vec3::from_slice));
    let turns = rotations[..3 * joints * count].chunks_exact(3);
    database
        .rotations
        .extend(turns.map(|code| -> Quat { rotation([code[0], code[1], code[2]]) }));
    let both = contacts
        .iter()
        .map(|codes| [contact(codes & 3), contact(codes >> 2)]);
    feet.contacts.extend(both);
    Ok(())
}

pub(super) fn put_columns(section: &mut Section, name: &str, columns: &QuantisedColumns) {
    section.put_array(&format!("{name}.low"), &columns.low);
    section.put_array(&format!("{name}.step"), &columns.step);
    section.put_array(name, &even(columns.codes.clone()));
}

pub(super) fn take_columns(
    section: &mut Section,
    name: &str,
    width: usize,
    rows: usize,
) -> Result<Vec<f32>, SectionError> {
    let low = section.take_finite(&format!("{name}.low"), width)?;
    let step = section.take_finite(&format!("{name}.step"), width)?;
    let mut codes: Vec<u16> = section.take_array(name, (width * rows).next_multiple_of(2))?;
    codes.truncate(width * rows);
    Ok(QuantisedColumns { low, step, codes }.values())
}

/// Codes filled up to whole words of four bytes.
fn even(mut codes: Vec<u16>) -> Vec<u16> {
    codes.resize(codes.len().next_multiple_of(2), 0);
    codes
}

fn code(contact: FootContact) -> u32 {
    match contact {
        FootContact::Air => 0,
        FootContact::Heel => 1,
        FootContact::Toe => 2,
    }
}

fn contact(code: u32) -> FootContact {
    match code {
        0 => FootContact::Air,
        1 => FootContact::Heel,
        _ => FootContact::Toe,
    }
}
