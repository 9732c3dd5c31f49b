//! What a list holds.

use std::path::PathBuf;

/// A list of recordings.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionList {
    /// The recordings, in the order of the motions drawn from.
    pub clips: Vec<ListedClip>,
    /// Where the list comes from: a TOML file, a folder or a recording.
    pub path: PathBuf,
    /// Whether recordings that are too short are left out: nobody has named them one by one.
    pub skip_short: bool,
}

/// A recording of a list.
#[derive(Clone, Debug, PartialEq)]
pub struct ListedClip {
    /// The file: BVH, or DeepMimic's JSON if it ends in `.txt`.
    pub file: PathBuf,
    /// Line of the list that names it, from 1; none in a folder.
    pub line: Option<usize>,
    /// First and last moment to use, s after the first frame that is no T-pose.
    pub span: [Option<f32>; 2],
    /// How likely it is to be drawn, against the others.
    pub weight: f32,
    /// Whether its mirrored copy is added, and shares the weight; none leaves it to the options.
    pub mirror: Option<bool>,
    /// A label of the user's.
    pub kind: String,
    /// Whether its feet are brought to the ground wherever they stand; none leaves it to the options.
    pub ground: Option<bool>,
}

impl ListedClip {
    /// All of a recording.
    pub(super) fn of(file: PathBuf) -> ListedClip {
        ListedClip {
            file,
            line: None,
            span: [None; 2],
            weight: 1.0,
            mirror: None,
            kind: String::new(),
            ground: None,
        }
    }
}
