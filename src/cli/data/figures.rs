//! Figures of a database, for people and programs to read.

use footwork::motion::RATE;
use footwork::motion::database::Database;
use footwork::motion::features::MIN_FUTURE_FRAMES;
use footwork::motion::roles::ROLES;
use footwork::motion::up::UpAxis;
use serde::Serialize;
use std::collections::BTreeMap;

/// What `data info --json` prints.
#[derive(Serialize)]
pub struct DataFigures {
    clips: Vec<ClipFigures>,
    minutes: f32,
    fingerprint: String,
    /// Names of the joints.
    roles: BTreeMap<&'static str, String>,
}

/// One clip of a database.
#[derive(Serialize)]
pub struct ClipFigures {
    pub name: String,
    pub seconds: f32,
    pub candidates: usize,
    /// Mean speed along the smoothed path on the ground, m/s.
    pub mean_speed: f32,
    /// Largest speed between two frames of it, m/s.
    pub max_speed: f32,
    /// Metres of one unit of its file; none if it comes from no file.
    pub unit_m: Option<f32>,
    /// The axis that was up in its file.
    pub up: Option<UpAxis>,
    pub notes: Vec<String>,
}

impl DataFigures {
    pub fn of(database: &Database) -> DataFigures {
        let clips = 0..database.clips.len();
        let joints = ROLES.into_iter().zip(database.roles.joints());
        DataFigures {
            clips: clips.map(|clip| ClipFigures::of(database, clip)).collect(),
            minutes: database.minutes(),
            fingerprint: format!("{:08x}", database.fingerprint),
            roles: joints
                .map(|(role, joint)| (role, database.skeleton.names[joint].clone()))
                .collect(),
        }
    }
}

impl ClipFigures {
    pub fn of(database: &Database, clip: usize) -> ClipFigures {
        let clip = &database.clips[clip];
        let path = database.path[clip.first..clip.first + clip.frames].windows(2);
        let steps = path.map(|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]));
        let seconds = clip.frames as f32 / RATE;
        ClipFigures {
            name: clip.name.clone(),
            seconds,
            candidates: clip.frames - MIN_FUTURE_FRAMES,
            mean_speed: steps.clone().sum::<f32>() / seconds,
            max_speed: steps.fold(0.0, f32::max) * RATE,
            unit_m: clip.findings.unit_m,
            up: clip.findings.up,
            notes: clip.findings.notes.clone(),
        }
    }
}
