//! Motion lists: files of recordings, which spans of them to use, and how often.
//!
//! A list is TOML with a table `[[clip]]` for each recording:
//! ```toml
//! [[clip]]
//! file = "cmu/daz43/69_06.bvh"  # seen from the folder given, or from the list's own
//! start = 0.5                   # s after the first frame that is no T-pose; 0 unless given
//! end = 13.57                   # s; to the recording's end unless given
//! weight = 3.4                  # how likely it is to be drawn, against the others; 1 unless given
//! mirror = true                 # its mirrored copy is added, and both share the weight
//! kind = "boxing"               # a label of your own, kept with the motion
//! ground = true                 # its feet are brought to the ground wherever they stand
//! ```
//! A file that does not exist is looked for by how its name begins. A folder, or one recording, is a
//! list too, of equal weights.

mod error;
mod file;
mod folder;
mod listed;
mod load;
mod options;
mod prepare;

pub use error::{MotionListError, Result, UnusableClip};
pub use listed::{ListedClip, MotionList};
pub use load::{ClipReport, LoadedMotions};
pub use options::MotionListOptions;

use std::path::Path;

impl MotionList {
    /// The list at `path`: a TOML file, a folder of recordings or a single one. Files that a TOML file
    /// names are seen from `folder` or, without one, from where the list is.
    ///
    /// # Errors
    /// A list that cannot be read, has a mistake, names no recording or one that is not there.
    pub fn read(path: &Path, folder: Option<&Path>) -> Result<MotionList> {
        if path.is_dir() {
            return folder::list(path);
        }
        match path.extension() {
            Some(end) if end.eq_ignore_ascii_case("toml") => {
                // The parent of a bare name is empty, which is no folder.
                let parent = path.parent().filter(|parent| *parent != Path::new(""));
                file::read(path, folder.or(parent).unwrap_or(Path::new(".")))
            }
            _ => Ok(MotionList {
                clips: vec![ListedClip::of(path.to_path_buf())],
                path: path.to_path_buf(),
                skip_short: false,
            }),
        }
    }
}
