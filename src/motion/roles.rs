//! Which joint plays which part: found by name, else by the form of the tree, or told by a small file.

mod names;
pub mod structure;

use super::error::{MotionError, MotionResult};
use super::skeleton::Skeleton;
use crate::input_file;
use std::path::Path;

/// Bytes of the longest roles file.
const MAX_BYTES: u64 = 1 << 24;

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

impl Roles {
    /// Finds the roles by the joints' names, without what programs put before them: LaFAN1, CMU
    /// (MotionBuilder and daz), Mixamo, `sim*` and most others that say left and right by a word or a
    /// letter. What names do not tell is found by the form of the tree.
    ///
    /// Errors: roles that no joint fits, with the list of joints and a roles file to complete.
    pub fn find(skeleton: &Skeleton) -> MotionResult<Roles> {
        Self::complete([None; 9], skeleton)
    }

    /// Reads roles from a TOML file of lines `left_foot = "joint name"`; what the file leaves
    /// out is found as without a file.
    ///
    /// Errors: an unreadable file, unknown keys, unknown joints (each names the nearest known).
    pub fn read(path: &Path, skeleton: &Skeleton) -> MotionResult<Roles> {
        let text =
            input_file::text(path, MAX_BYTES).map_err(|error| format!("cannot be read: {error}"));
        let given = text.and_then(|text| given(&text, skeleton));
        let given = given.map_err(|problem| MotionError::RolesFile {
            path: path.to_path_buf(),
            problem,
        })?;
        Self::complete(given, skeleton).map_err(|error| error.within(path))
    }

    /// Fills in what is not given.
    fn complete(mut given: [Option<usize>; 9], skeleton: &Skeleton) -> MotionResult<Roles> {
        let told = given[0].is_some();
        fill(&mut given, names::find(&skeleton.names));
        if given.contains(&None) {
            fill(
                &mut given,
                structure::find(skeleton).map_or([None; 9], |all| all.map(Some)),
            );
        }
        if !told {
            given[0] = hips(&given, skeleton);
        }
        // A foot that only the file could name still serves as the toe.
        given[5] = given[5].or(given[3]);
        given[6] = given[6].or(given[4]);
        let found: Vec<usize> = given.into_iter().flatten().collect();
        let Ok(joints) = <[usize; 9]>::try_from(found) else {
            let missing = (0..9).filter(|&role| given[role].is_none());
            return Err(MotionError::MissingRoles {
                missing: missing
                    .map(|role| ROLES[role])
                    .collect::<Vec<_>>()
                    .join(", ")
                    .into(),
                joints: skeleton.names.join(", ").into(),
                file: file(&given, skeleton).into(),
            });
        };
        let roles = Roles::of(joints);
        roles.check(skeleton)?;
        Ok(roles)
    }

    /// The roles of these joints, in the order of [`ROLES`].
    pub fn of(joints: [usize; 9]) -> Roles {
        let [
            hips,
            left_hip,
            right_hip,
            left_foot,
            right_foot,
            left_toe,
            right_toe,
            left_shoulder,
            right_shoulder,
        ] = joints;
        Roles {
            hips,
            left_hip,
            right_hip,
            left_foot,
            right_foot,
            left_toe,
            right_toe,
            left_shoulder,
            right_shoulder,
        }
    }

    /// The roles with left and right exchanged.
    pub fn exchanged(&self) -> Roles {
        let mut joints = self.joints();
        for left in [1, 3, 5, 7] {
            joints.swap(left, left + 1);
        }
        Roles::of(joints)
    }

    /// A roles file that says the same.
    pub fn to_file(&self, skeleton: &Skeleton) -> String {
        file(&self.joints().map(Some), skeleton)
    }

    /// The roles whose joints were found by the form of the tree, since no name tells them.
    pub fn unnamed(&self, skeleton: &Skeleton) -> Vec<&'static str> {
        let named = names::find(&skeleton.names);
        let joints = self.joints();
        let unnamed = (0..9).filter(|&role| named[role] != Some(joints[role]));
        unnamed.map(|role| ROLES[role]).collect()
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

/// Fills in what is missing.
fn fill(given: &mut [Option<usize>; 9], found: [Option<usize>; 9]) {
    for (given, found) in given.iter_mut().zip(found) {
        *given = given.or(found);
    }
}

/// The joint called hips if legs and arms hang on it, else the lowest on which they do.
fn hips(found: &[Option<usize>; 9], skeleton: &Skeleton) -> Option<usize> {
    let limbs: Vec<usize> = [1, 2, 7, 8]
        .iter()
        .filter_map(|&role| found[role])
        .collect();
    let carries = |hips: usize| limbs.iter().all(|&limb| below(skeleton, limb, hips));
    match found[0] {
        Some(hips) if limbs.len() < 4 || carries(hips) => Some(hips),
        _ if limbs.len() == 4 => structure::common_ancestor(skeleton, &limbs),
        _ => None,
    }
}

/// A roles file; lines of roles without a joint are left to be completed.
fn file(roles: &[Option<usize>; 9], skeleton: &Skeleton) -> String {
    let name = |joint: Option<usize>| joint.map_or("", |joint| &skeleton.names[joint]);
    let line = |(role, &joint)| format!("{role} = {}\n", toml::Value::from(name(joint)));
    ROLES.iter().zip(roles).map(line).collect()
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
