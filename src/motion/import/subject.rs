//! One recording as it is read, before anything is decided for its folder.

use crate::motion::body::{self, BodyRecording};
use crate::motion::bvh;
use crate::motion::error::{MotionError, MotionResult};
use crate::motion::findings::{Finding, listed};
use crate::motion::manifest::Entry;
use crate::motion::roles::{ROLES, Roles};
use crate::motion::skeleton::Skeleton;
use crate::motion::units;
use crate::motion::up::{self, UpEvidence};
use std::path::{Path, PathBuf};

/// The body in a file, and what it shows by itself.
pub struct Subject {
    pub file: PathBuf,
    /// What its clip is to be called.
    pub name: String,
    /// What the manifest says of it.
    pub entry: Option<Entry>,
    pub body: BodyRecording,
    pub stance: UpEvidence,
    /// Length of a leg, file units.
    pub leg: f32,
    pub findings: Vec<Finding>,
}

impl Subject {
    pub fn read(
        file: &Path,
        name: String,
        entry: Option<&Entry>,
        roles: Option<&Path>,
    ) -> MotionResult<Subject> {
        let recording = bvh::read(file)?;
        let within = |error: MotionError| error.within(file);
        let found = match roles {
            Some(path) => Roles::read(path, &recording.skeleton)?,
            None => Roles::find(&recording.skeleton).map_err(within)?,
        };
        let mut findings = Vec::new();
        if roles.is_none() {
            findings.extend(unnamed(&found, &recording.skeleton));
        }
        let body = body::extract(recording, &found).map_err(within)?;
        if !body.left_out.is_empty() {
            let what = "joints outside of the body left out";
            findings.push(Finding::new(what, listed(&body.left_out)));
        }
        Ok(Subject {
            file: file.to_path_buf(),
            name,
            entry: entry.cloned(),
            stance: up::find(&body.recording, &body.roles),
            leg: units::leg(&body.recording.skeleton, &body.roles),
            body,
            findings,
        })
    }
}

/// The roles that were found by the form of the skeleton.
fn unnamed(roles: &Roles, skeleton: &Skeleton) -> Option<Finding> {
    let unnamed = roles.unnamed(skeleton);
    let joints = ROLES.iter().zip(roles.joints());
    let joints = joints.filter(|(role, _)| unnamed.contains(role));
    let pairs: Vec<String> = joints
        .map(|(role, joint)| format!("{role} = {}", skeleton.names[joint]))
        .collect();
    let what = "roles found by the form of the skeleton, since names do not tell them";
    (!pairs.is_empty()).then(|| Finding::new(what, pairs.join(", ")))
}
