//! A set of clips as motion matching and playback need it, in plain arrays.
//!
//! `docs/database.md` documents the file field by field.
//!
//! ```
//! use footwork::motion::{database::Database, normalise::Weights, synthetic};
//!
//! let (clips, roles) = synthetic::perform(1, 0.5);
//! let folder = tempfile::tempdir()?;
//! let path = folder.path().join("motion.footwork");
//! Database::build(&clips, roles, Weights::PAPER)?.save(&path)?;
//!
//! let database = Database::load(&path)?;
//! let frame = database.candidates[100] as usize;
//! let [x, z, heading_x, heading_z] = database.path[frame];
//! let joints = database.skeleton.joints();
//! let rotations = &database.rotations[frame * joints..][..joints];
//! let (positions, _) = database.skeleton.world(database.hips[frame], rotations);
//! let [left, ..] = database.features[frame]; // normalised
//! let left = left / database.normalisation.scale[0] + database.normalisation.mean[0];
//! let foot = positions[database.roles.left_foot];
//! let away = heading_z * (foot.x - x) - heading_x * (foot.z - z);
//! assert!((left - away).abs() < 1e-5, "the left foot is as far to the left as its feature says");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use super::character_frame::to_local;
use super::clip::Clip;
use super::features::{FEATURE_DIM, FRAMES_PER_STEP, MIN_FUTURE_FRAMES, ROW_STRIDE, extract};
use super::findings::ClipFindings;
use super::normalise::{Normalisation, Weights};
use super::roles::Roles;
use super::skeleton::Skeleton;
use crate::container::{Arrays, Format, StoreError};
use glam::{Quat, Vec3};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The frames of a clip in the database.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ClipRecord {
    /// Name of the clip.
    pub name: String,
    /// Its first frame in the database.
    pub first: usize,
    /// Number of its frames.
    pub frames: usize,
    /// Where it comes from; empty if unknown.
    pub source: String,
    /// Terms of use; empty if unknown.
    pub licence: String,
    /// How its file was read, where it comes from one.
    #[serde(default)]
    pub findings: ClipFindings,
}

/// Six frames of root motion from a candidate, in its character frame.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct RootMotion {
    /// Ground displacement, m.
    pub moved: [f32; 2],
    /// New forward direction, unit.
    pub turned: [f32; 2],
    /// Length of the path, m.
    pub length: f32,
}

/// All clips joined: one row a frame at 30 Hz.
#[derive(Clone, Debug)]
pub struct Database {
    /// Bone lengths of the first clip; every clip has the same joints.
    pub skeleton: Skeleton,
    /// Joints of the feature.
    pub roles: Roles,
    /// Clips in the order of their frames.
    pub clips: Vec<ClipRecord>,
    /// Weights of the features.
    pub weights: Weights,
    /// Mean and scale of the features.
    pub normalisation: Normalisation,
    /// Normalised features, `[frame][ROW_STRIDE]`, padded with zeros.
    pub features: Vec<[f32; ROW_STRIDE]>,
    /// The character's smoothed path in its clip's world: x, z (m), heading x, heading z.
    pub path: Vec<[f32; 4]>,
    /// World position of the hips in the clip, m.
    pub hips: Vec<Vec3>,
    /// Local rotations, `[frame][joint]`.
    pub rotations: Vec<Quat>,
    /// Frames that can be matched, ascending. The search returns indices into this list.
    pub candidates: Vec<u32>,
    /// Root motion of each candidate.
    pub motion: Vec<RootMotion>,
    /// Checksum of all that a policy depends on: features and root motion.
    pub fingerprint: u32,
}

#[derive(Serialize, Deserialize)]
struct Header {
    skeleton: Skeleton,
    roles: Roles,
    clips: Vec<ClipRecord>,
    weights: Weights,
    normalisation: Normalisation,
    frames: usize,
}

/// Bones, m, and other numbers of a database are smaller.
const LONGEST_BONE: f32 = 100.0;
const MOST: f32 = 1e9;

impl Header {
    /// Whether all its numbers are such as motion has.
    fn is_plausible(&self) -> bool {
        let ends = self.skeleton.ends.iter().map(|(_, offset)| offset);
        let mut bones = self.skeleton.offsets.iter().chain(ends);
        let weights = self.weights.all();
        let Normalisation { mean, scale } = &self.normalisation;
        bones.all(|bone| bone.length() <= LONGEST_BONE)
            && weights.iter().all(|weight| (0.0..=MOST).contains(weight))
            && mean.iter().all(|mean| mean.abs() <= MOST)
            && scale.iter().all(|scale| *scale >= 0.0 && *scale <= MOST)
    }
}

/// No clip has a frame whose next second is known.
#[derive(Debug, thiserror::Error)]
#[error(
    "nothing to match: every clip is shorter than the {MIN_FUTURE_FRAMES} future frames of the trajectory feature; use longer clips"
)]
pub struct NothingToMatch;

const FORMAT: Format = Format {
    kind: "database",
    version: 1,
};

impl Database {
    /// Joins clips of one skeleton.
    ///
    /// # Errors
    /// If no clip is longer than the 30 future frames a candidate needs.
    pub fn build(clips: &[Clip], roles: Roles, weights: Weights) -> Result<Self, NothingToMatch> {
        use rayon::prelude::*;
        let clips: Vec<&Clip> = clips
            .iter()
            .filter(|clip| clip.frames() > MIN_FUTURE_FRAMES)
            .collect();
        let Some(first) = clips.first() else {
            return Err(NothingToMatch);
        };
        let tracks: Vec<_> = clips.par_iter().map(|clip| extract(clip, &roles)).collect();
        let (mut records, mut raw, mut path) = (Vec::new(), Vec::new(), Vec::new());
        for (clip, track) in clips.iter().zip(&tracks) {
            records.push(ClipRecord {
                name: clip.name.clone(),
                first: raw.len(),
                frames: clip.frames(),
                source: clip.source.clone(),
                licence: clip.licence.clone(),
                findings: ClipFindings::default(),
            });
            raw.extend_from_slice(&track.features);
            path.extend(
                track
                    .ground
                    .iter()
                    .zip(&track.heading)
                    .map(|(g, h)| [g[0], g[1], h[0], h[1]]),
            );
        }
        let candidates = candidates(&records);
        let normalisation = Normalisation::of(
            candidates.iter().map(|&frame| &raw[frame as usize]),
            &weights,
        );
        let features = raw
            .iter()
            .map(|row| pad(&normalisation.apply(row)))
            .collect();
        let header = Header {
            skeleton: first.skeleton.clone(),
            roles,
            clips: records,
            weights,
            normalisation,
            frames: raw.len(),
        };
        let hips = clips
            .iter()
            .flat_map(|clip| clip.positions.iter().copied())
            .collect();
        let rotations = clips
            .iter()
            .flat_map(|clip| clip.rotations.iter().copied())
            .collect();
        Ok(Self::join(header, features, path, hips, rotations))
    }

    fn join(
        header: Header,
        features: Vec<[f32; ROW_STRIDE]>,
        path: Vec<[f32; 4]>,
        hips: Vec<Vec3>,
        rotations: Vec<Quat>,
    ) -> Self {
        let candidates = candidates(&header.clips);
        let motion: Vec<RootMotion> = candidates
            .iter()
            .map(|&frame| root_motion(&path, frame as usize))
            .collect();
        let mut hash = crc32fast::Hasher::new();
        hash.update(bytemuck::cast_slice(&features));
        hash.update(bytemuck::cast_slice(&candidates));
        hash.update(bytemuck::cast_slice(&motion));
        Database {
            skeleton: header.skeleton,
            roles: header.roles,
            clips: header.clips,
            weights: header.weights,
            normalisation: header.normalisation,
            features,
            path,
            hips,
            rotations,
            candidates,
            motion,
            fingerprint: hash.finalize(),
        }
    }

    /// The clip that a frame belongs to.
    pub fn clip(&self, frame: usize) -> &ClipRecord {
        let after = self.clips.partition_point(|clip| clip.first <= frame);
        &self.clips[after - 1]
    }

    /// A clip as it was recorded, at 30 Hz; all clips have the skeleton of the first.
    pub fn recording(&self, clip: usize) -> Clip {
        let ClipRecord { first, frames, .. } = self.clips[clip];
        let joints = self.skeleton.joints();
        Clip {
            name: self.clips[clip].name.clone(),
            skeleton: self.skeleton.clone(),
            rate: super::RATE,
            positions: self.hips[first..][..frames].to_vec(),
            rotations: self.rotations[first * joints..][..frames * joints].to_vec(),
            source: self.clips[clip].source.clone(),
            licence: self.clips[clip].licence.clone(),
        }
    }

    /// Frames of all clips.
    pub fn frames(&self) -> usize {
        self.features.len()
    }

    /// Length of all clips together, minutes.
    pub fn minutes(&self) -> f32 {
        self.frames() as f32 / super::RATE / 60.0
    }

    /// Normalised, padded features of all candidates.
    pub fn rows(&self) -> Vec<[f32; ROW_STRIDE]> {
        self.candidates
            .iter()
            .map(|&frame| self.features[frame as usize])
            .collect()
    }

    /// Ground velocity (m/s, character frame: left, forward) and turning rate (degrees a second,
    /// positive to the left) of every frame but the last of its clip.
    pub fn ground_motion(&self) -> Vec<([f32; 2], f32)> {
        let frames = self
            .clips
            .iter()
            .flat_map(|clip| clip.first..clip.first + clip.frames - 1);
        frames
            .map(|frame| {
                let ([x, z, hx, hz], next) = (self.path[frame], self.path[frame + 1]);
                let moved = to_local([next[0] - x, next[1] - z], [hx, hz]);
                let turned = to_local([next[2], next[3]], [hx, hz]);
                let rate = super::RATE;
                (
                    moved.map(|v| v * rate),
                    turned[0].atan2(turned[1]).to_degrees() * rate,
                )
            })
            .collect()
    }

    /// Writes one checksummed file, whole or not at all.
    pub fn save(&self, path: &Path) -> Result<(), StoreError> {
        let header = Header {
            skeleton: self.skeleton.clone(),
            roles: self.roles,
            clips: self.clips.clone(),
            weights: self.weights,
            normalisation: self.normalisation.clone(),
            frames: self.frames(),
        };
        let mut arrays = Arrays::default();
        arrays.put("features", self.features.as_flattened());
        arrays.put("path", self.path.as_flattened());
        arrays.put(
            "hips",
            &self.hips.iter().map(Vec3::to_array).collect::<Vec<_>>(),
        );
        arrays.put(
            "rotations",
            &self
                .rotations
                .iter()
                .map(Quat::to_array)
                .collect::<Vec<_>>(),
        );
        crate::container::save(path, FORMAT, &header, &arrays)
    }

    /// Reads a file written by [`Database::save`].
    pub fn load(path: &Path) -> Result<Self, StoreError> {
        let (header, mut arrays) = crate::container::load::<Header>(path, FORMAT)?;
        let damaged = |why: &str| StoreError::Damaged {
            path: path.to_path_buf(),
            why: why.to_string(),
        };
        let features: Vec<[f32; ROW_STRIDE]> = arrays
            .take("features")
            .ok_or_else(|| damaged("no features"))?;
        let ground: Vec<[f32; 4]> = arrays.take("path").ok_or_else(|| damaged("no path"))?;
        let hips: Vec<[f32; 3]> = arrays.take("hips").ok_or_else(|| damaged("no hips"))?;
        let rotations: Vec<[f32; 4]> = arrays
            .take("rotations")
            .ok_or_else(|| damaged("no rotations"))?;
        let (frames, joints) = (header.frames, header.skeleton.joints());
        let mut end = 0;
        let consecutive = header.clips.iter().all(|clip| {
            let fits = clip.first == end && clip.frames > MIN_FUTURE_FRAMES;
            end = clip.first.saturating_add(clip.frames);
            fits
        });
        let sizes = [features.len(), ground.len(), hips.len(), end];
        if frames == 0 || !consecutive || sizes != [frames; 4] {
            return Err(damaged("clips and arrays do not fit together"));
        }
        if !header.skeleton.is_tree() || !header.roles.joints().iter().all(|&role| role < joints) {
            return Err(damaged("its skeleton is no tree of joints"));
        }
        if !header.is_plausible() {
            return Err(damaged("its header has numbers that no motion has"));
        }
        if rotations.len() != frames * joints {
            return Err(damaged("skeleton and rotations do not fit together"));
        }
        let numbers = [
            features.as_flattened(),
            ground.as_flattened(),
            hips.as_flattened(),
            rotations.as_flattened(),
        ];
        let most = |numbers: &&[f32]| numbers.iter().all(|number| number.abs() <= MOST);
        if !numbers.iter().all(most) {
            return Err(damaged(
                "it has numbers that are not finite, or larger than any of motion",
            ));
        }
        let hips = hips.into_iter().map(Vec3::from_array).collect();
        let rotations = rotations.into_iter().map(Quat::from_array).collect();
        Ok(Self::join(header, features, ground, hips, rotations))
    }
}

fn pad(row: &[f32; FEATURE_DIM]) -> [f32; ROW_STRIDE] {
    std::array::from_fn(|i| if i < FEATURE_DIM { row[i] } else { 0.0 })
}

/// The frames of clips that can be matched, ascending.
pub fn candidates(clips: &[ClipRecord]) -> Vec<u32> {
    clips
        .iter()
        .flat_map(|clip| clip.first as u32..(clip.first + clip.frames - MIN_FUTURE_FRAMES) as u32)
        .collect()
}

/// The motion of the six frames from `frame` on, along a path of x, z (m), heading x, heading z.
pub fn root_motion(path: &[[f32; 4]], frame: usize) -> RootMotion {
    let [x, z, hx, hz] = path[frame];
    let [x6, z6, hx6, hz6] = path[frame + FRAMES_PER_STEP];
    let heading = [hx, hz];
    let length = path[frame..=frame + FRAMES_PER_STEP]
        .windows(2)
        .map(|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]))
        .sum();
    RootMotion {
        moved: to_local([x6 - x, z6 - z], heading),
        turned: to_local([hx6, hz6], heading),
        length,
    }
}
