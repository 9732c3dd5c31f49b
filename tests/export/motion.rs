//! What tests of motion and models share.

use super::cases::{Files, UntrainedRun};
use footwork::export::character::MovingCharacter;
use footwork::export::episode::characters;
use std::path::PathBuf;
use std::sync::LazyLock;

/// Every kind of motion: whole bodies of recordings, one simulated body, one with a box, two.
pub static KINDS: LazyLock<[UntrainedRun; 4]> = LazyLock::new(|| {
    let files = Files::new();
    ["plane", "stand", "punch", "box"].map(|task| files.run(task))
});

impl UntrainedRun {
    /// Those who move in the excerpt.
    pub fn characters(&self) -> Vec<MovingCharacter> {
        characters(&self.trained()).unwrap()
    }

    /// The run in a format, as a file that is kept for a look.
    pub fn kept(&self, format: &str, ending: &str) -> PathBuf {
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
        let path = folder.join(format!("{}.{ending}", self.name));
        std::fs::write(&path, self.exported(format)).unwrap();
        path
    }
}
