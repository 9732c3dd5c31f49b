//! Left and right in the names of joints.

/// Words for left and for right, as names have them.
const WORDS: [(&str, &str); 4] = [
    ("Left", "Right"),
    ("left", "right"),
    ("LEFT", "RIGHT"),
    ("左", "右"),
];

/// What a joint's name says of its side.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sided {
    /// Whether it is on the left.
    pub left: bool,
    /// The name of the same joint on the other side.
    pub other: String,
}

/// The side in a name: a word (LeftArm, mixamorig:LeftArm, simLeftArm, leftEye, 左腕) or a letter
/// (LHipJoint, lShldr, L_Hip, thigh_l, Hand.R). None for joints of the middle.
pub fn side(name: &str) -> Option<Sided> {
    for (left, right) in WORDS {
        for (word, other, is_left) in [(left, right, true), (right, left, false)] {
            if name.contains(word) {
                return Some(Sided {
                    left: is_left,
                    other: name.replacen(word, other, 1),
                });
            }
        }
    }
    let parts: Vec<(usize, char)> = name.char_indices().collect();
    let is_side = |at: usize| {
        let (_, letter) = parts[at];
        let break_before = at == 0 || !parts[at - 1].1.is_alphanumeric();
        let break_after = parts.get(at + 1).is_none_or(|c| !c.1.is_alphanumeric());
        // A letter alone between breaks, or one that begins a name and is followed by a capital.
        let begins = break_before && parts.get(at + 1).is_some_and(|c| c.1.is_uppercase());
        matches!(letter, 'l' | 'r' | 'L' | 'R') && break_before && (break_after || begins)
    };
    let at = (0..parts.len()).find(|&at| parts.len() > 1 && is_side(at))?;
    let (start, letter) = parts[at];
    let other = match letter {
        'l' => "r",
        'r' => "l",
        'L' => "R",
        _ => "L",
    };
    Some(Sided {
        left: matches!(letter, 'l' | 'L'),
        other: format!("{}{other}{}", &name[..start], &name[start + 1..]),
    })
}
