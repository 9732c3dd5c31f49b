//! Lists of recordings, DeepMimic's among them, and mirrored motions.

mod deepmimic;
mod lists;
mod mirror;
mod real;
mod refused;

use crate::retarget::performed;
use footwork::motion::bvh;
use footwork::physics::humanoid::humanoid;
use footwork::physics::model::Model;
use footwork::physics::motion_list::{
    LoadedMotions, MotionList, MotionListError, MotionListOptions,
};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tempfile::TempDir;

/// Where numbers of a DeepMimic frame begin.
const ROOT: usize = 1;
const ROOT_ROTATION: usize = 4;
const RIGHT_KNEE: usize = 20;
const RIGHT_ELBOW: usize = 29;
const LEFT_KNEE: usize = 34;
const LEFT_ELBOW: usize = 43;

/// A DeepMimic frame: its character stands, arms hanging.
fn standing(duration: f64) -> Vec<f64> {
    let mut frame = vec![0.0; 44];
    frame[0] = duration;
    frame[ROOT + 1] = 0.88;
    for rotation in [4, 8, 12, 16, 21, 25, 30, 35, 39] {
        frame[rotation] = 1.0;
    }
    frame
}

/// A DeepMimic recording at 30 Hz of somebody who climbs a step of 0.4 m halfway.
fn climbing() -> Vec<Vec<f64>> {
    let mut frames = vec![standing(1.0 / 30.0); 180];
    for frame in &mut frames[90..] {
        frame[ROOT + 1] += 0.4;
    }
    frames
}

/// A folder for recordings and lists.
struct Folder(TempDir);

impl Folder {
    fn new() -> Folder {
        Folder(tempfile::tempdir().expect("a folder"))
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn text(&self, name: &str, text: &str) -> PathBuf {
        let path = self.path(name);
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("made");
        std::fs::write(&path, text).expect("written");
        path
    }

    fn deepmimic(&self, name: &str, frames: &[Vec<f64>]) -> PathBuf {
        let file = json!({ "Loop": "wrap", "Frames": frames });
        self.text(name, &file.to_string())
    }

    /// So many frames of the performer.
    fn bvh(&self, name: &str, frames: usize) -> PathBuf {
        let (mut clip, _) = performed();
        clip.positions.truncate(frames);
        clip.rotations.truncate(frames * clip.skeleton.joints());
        let path = self.text(name, "");
        bvh::write(&path, &clip).expect("written");
        path
    }
}

fn load_with(path: &Path, options: &MotionListOptions) -> Result<LoadedMotions, MotionListError> {
    let model = Arc::new(humanoid());
    MotionList::read(path, None)?.load(&model, options)
}

fn load(path: &Path) -> Result<LoadedMotions, MotionListError> {
    load_with(path, &MotionListOptions::default())
}

fn names(loaded: &LoadedMotions) -> Vec<&str> {
    let motions = loaded.library.motions().iter();
    motions.map(|motion| motion.name.as_str()).collect()
}

/// Positions of the named joint.
fn joint(model: &Model, name: &str) -> usize {
    let joint = model.joints.iter().find(|joint| joint.name == name);
    joint.expect("a humanoid's joint").q
}
