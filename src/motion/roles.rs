//! Which joint plays which part: found by name, or told by a small file.

use super::error::{MotionError, MotionResult};
use super::skeleton::Skeleton;
use std::path::Path;

/// Joint indices of the parts that features, playback and mirroring need.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Roles {
    /// The root.
    pub hips: usize,
    /// Tops of the thighs.
    pub left_hip: usize,
    /// Right hip joint.
    pub right_hip: usize,
    /// Ankles.
    pub left_foot: usize,
    /// Right ankle.
    pub right_foot: usize,
    /// Left toe joint.
    pub left_toe: usize,
    /// Right toe joint.
    pub right_toe: usize,
    /// Tops of the upper arms.
    pub left_shoulder: usize,
    /// Right shoulder joint.
    pub right_shoulder: usize,
}

/// The keys of a roles file, in the order of the struct's fields.
pub const ROLES: [&str; 9] = [
    "hips",
    "left_hip",
    "right_hip",
    "left_foot",
    "right_foot",
    "left_toe",
    "right_toe",
    "left_shoulder",
    "right_shoulder",
];

/// What the conventions call each part, the surest name first. Skeletons with collar bones call
/// them "shoulder" and the upper arm "arm"; those with ankles call the toe joint "foot". So
/// "shoulder" and "foot" come late in their lists. A skeleton without toes ends at the foot,
/// which then plays the toe as well.
const HIPS: &[&str] = &["hips", "hip", "pelvis"];
const HIP: &[&str] = &["upleg", "thigh", "upperleg", "hip"];
const FOOT: &[&str] = &["ankle", "foot"];
const TOE: &[&str] = &["toebase", "toe", "toes", "toe0", "ball", "foot", "ankle"];
const SHOULDER: &[&str] = &["arm", "shldr", "upperarm", "uparm", "shoulder"];

impl Roles {
    /// Finds the roles by the joints' names: LaFAN1, CMU (MotionBuilder and daz), Mixamo, `sim*`
    /// and most others that say left and right by a word or a letter.
    ///
    /// Errors: roles that no joint's name fits, with the list of joints.
    pub fn find(skeleton: &Skeleton) -> MotionResult<Roles> {
        Self::complete([None; 9], skeleton)
    }

    /// Reads roles from a TOML file of lines `left_foot = "joint name"`; what the file leaves
    /// out is found by name.
    ///
    /// Errors: an unreadable file, unknown keys, unknown joints (each names the nearest known).
    pub fn read(path: &Path, skeleton: &Skeleton) -> MotionResult<Roles> {
        let text =
            std::fs::read_to_string(path).map_err(|error| format!("cannot be read: {error}"));
        let given = text.and_then(|text| given(&text, skeleton));
        let given = given.map_err(|problem| MotionError::RolesFile {
            path: path.to_path_buf(),
            problem,
        })?;
        Self::complete(given, skeleton).map_err(|error| error.within(path))
    }

    /// Fills in by name what is not given.
    fn complete(mut given: [Option<usize>; 9], skeleton: &Skeleton) -> MotionResult<Roles> {
        let names: Vec<String> = skeleton.names.iter().map(|name| plain(name)).collect();
        for (role, joint) in given.iter_mut().enumerate() {
            *joint = joint.or_else(|| by_name(role, &names));
        }
        // A foot that only the file could name still serves as the toe.
        given[5] = given[5].or(given[3]);
        given[6] = given[6].or(given[4]);
        let missing: Vec<&str> = (0..9)
            .filter(|&role| given[role].is_none())
            .map(|role| ROLES[role])
            .collect();
        let found: Vec<usize> = given.into_iter().flatten().collect();
        let &[
            hips,
            left_hip,
            right_hip,
            left_foot,
            right_foot,
            left_toe,
            right_toe,
            left_shoulder,
            right_shoulder,
        ] = found.as_slice()
        else {
            return Err(MotionError::MissingRoles {
                missing: missing.join(", "),
                joints: skeleton.names.join(", "),
            });
        };
        let roles = Roles {
            hips,
            left_hip,
            right_hip,
            left_foot,
            right_foot,
            left_toe,
            right_toe,
            left_shoulder,
            right_shoulder,
        };
        roles.check(skeleton)?;
        Ok(roles)
    }

    /// Joint indices in the order of [`ROLES`].
    pub fn joints(&self) -> [usize; 9] {
        [
            self.hips,
            self.left_hip,
            self.right_hip,
            self.left_foot,
            self.right_foot,
            self.left_toe,
            self.right_toe,
            self.left_shoulder,
            self.right_shoulder,
        ]
    }

    /// The parts must be different joints, and feet hang below their hips below the pelvis.
    fn check(&self, skeleton: &Skeleton) -> MotionResult<()> {
        let joints = self.joints();
        let chains = [
            (1, 0),
            (2, 0),
            (3, 1),
            (4, 2),
            (5, 3),
            (6, 4),
            (7, 0),
            (8, 0),
        ];
        for (low, high) in chains {
            let toe_is_foot = (low == 5 || low == 6) && joints[low] == joints[high];
            if !toe_is_foot && !below(skeleton, joints[low], joints[high]) {
                return Err(MotionError::Roles {
                    problem: format!(
                        "{} ('{}') does not hang below {} ('{}')",
                        ROLES[low],
                        skeleton.names[joints[low]],
                        ROLES[high],
                        skeleton.names[joints[high]]
                    ),
                });
            }
        }
        for left in [1, 3, 5, 7] {
            if joints[left] == joints[left + 1] {
                return Err(MotionError::Roles {
                    problem: format!(
                        "{} and {} are both '{}'",
                        ROLES[left],
                        ROLES[left + 1],
                        skeleton.names[joints[left]]
                    ),
                });
            }
        }
        Ok(())
    }
}

/// Whether `low` is a true descendant of `high`.
fn below(skeleton: &Skeleton, low: usize, high: usize) -> bool {
    std::iter::successors(skeleton.parents[low], |&joint| skeleton.parents[joint])
        .any(|joint| joint == high)
}

/// A name without its namespace, a program's prefix, punctuation and case.
fn plain(name: &str) -> String {
    let name = name.rsplit(':').next().unwrap_or(name);
    let kept = name.chars().filter(|c| c.is_alphanumeric());
    let name: String = kept.flat_map(char::to_lowercase).collect();
    let stripped = name
        .strip_prefix("mixamorig")
        .map(|rest| rest.trim_start_matches(|c: char| c.is_ascii_digit()))
        .or_else(|| name.strip_prefix("sim"))
        .or_else(|| name.strip_prefix("bip001"))
        .or_else(|| name.strip_prefix("bip01"));
    stripped.unwrap_or(&name).to_string()
}

fn by_name(role: usize, names: &[String]) -> Option<usize> {
    let position = |wanted: String| names.iter().position(|name| *name == wanted);
    let parts = match role {
        0 => return HIPS.iter().find_map(|part| position(part.to_string())),
        1 | 2 => HIP,
        3 | 4 => FOOT,
        5 | 6 => TOE,
        _ => SHOULDER,
    };
    let (word, letter) = match role % 2 {
        1 => ("left", "l"),
        _ => ("right", "r"),
    };
    parts.iter().find_map(|part| {
        position(format!("{word}{part}"))
            .or_else(|| position(format!("{letter}{part}")))
            .or_else(|| position(format!("{part}{letter}")))
            .or_else(|| position(format!("{part}{word}")))
    })
}

/// The roles that a file names, in the order of [`ROLES`].
fn given(text: &str, skeleton: &Skeleton) -> Result<[Option<usize>; 9], String> {
    // The parser's message shows the line and points at the position.
    let table: toml::Table = text
        .parse()
        .map_err(|error: toml::de::Error| error.to_string().trim().to_string())?;
    let mut given = [None; 9];
    for (key, value) in &table {
        let role = ROLES.iter().position(|role| role == key).ok_or_else(|| {
            let nearest = nearest(key, ROLES.iter().copied());
            format!(
                "unknown role '{key}'{nearest}; the roles are {}",
                ROLES.join(", ")
            )
        })?;
        let name = value
            .as_str()
            .ok_or_else(|| format!("{key} must be a joint's name in quotes, not {value}"))?;
        let joint = skeleton.names.iter().position(|joint| joint == name);
        given[role] = Some(joint.ok_or_else(|| {
            let names = skeleton.names.iter().map(String::as_str);
            let nearest = nearest(name, names);
            let joints = skeleton.names.join(", ");
            format!("{key}: no joint is called '{name}'{nearest}; the joints are {joints}")
        })?);
    }
    Ok(given)
}

/// ", did you mean 'x'?" for the most similar of the known words.
fn nearest<'a>(word: &str, known: impl Iterator<Item = &'a str>) -> String {
    known
        .min_by_key(|known| strsim::damerau_levenshtein(word, known))
        .map(|known| format!(", did you mean '{known}'?"))
        .unwrap_or_default()
}
