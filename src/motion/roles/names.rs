//! Roles by the names of the joints.

/// What the conventions call each part, the surest name first. Skeletons with collar bones call
/// them "shoulder" and the upper arm "arm"; those with ankles call the toe joint "foot". So
/// "shoulder" and "foot" come late in their lists. A skeleton without toes ends at the foot,
/// which then plays the toe as well.
const HIPS: &[&str] = &["hips", "hip", "pelvis"];
const HIP: &[&str] = &["upleg", "thigh", "upperleg", "hip"];
const FOOT: &[&str] = &["ankle", "foot"];
const TOE: &[&str] = &["toebase", "toe", "toes", "toe0", "ball", "foot", "ankle"];
const SHOULDER: &[&str] = &["arm", "shldr", "upperarm", "uparm", "shoulder"];

/// What programs put before single names; a number may follow.
const PREFIXES: [&str; 3] = ["mixamorig", "sim", "bip"];

/// A prefix is what this fraction of all joints begin with; props and helpers may lack it.
const SHARED: f32 = 0.75;

/// The joints that names give the roles, in the order of [`ROLES`](super::ROLES).
pub fn find(names: &[String]) -> [Option<usize>; 9] {
    let names: Vec<String> = names.iter().map(|name| plain(name)).collect();
    let prefix = shared_prefix(&names);
    let names: Vec<&str> = names
        .iter()
        .map(|name| name.strip_prefix(prefix).unwrap_or(name))
        .collect();
    std::array::from_fn(|role| joint(role, &names))
}

/// A name without its namespace, a program's prefix, punctuation and case.
fn plain(name: &str) -> String {
    let name = name.rsplit(':').next().unwrap_or(name);
    let kept = name.chars().filter(|c| c.is_alphanumeric());
    let name: String = kept.flat_map(char::to_lowercase).collect();
    let stripped = PREFIXES.iter().find_map(|prefix| name.strip_prefix(prefix));
    let numbered = stripped.map(|rest| rest.trim_start_matches(|c: char| c.is_ascii_digit()));
    numbered.map_or(name.clone(), str::to_string)
}

/// The longest beginning that nearly all names share, as `character1` or `ccbase`.
fn shared_prefix(names: &[String]) -> &str {
    let mut sorted: Vec<&str> = names.iter().map(String::as_str).collect();
    sorted.sort_unstable();
    // Of sorted names in a row, the first and the last share what all do.
    let sharing = ((SHARED * sorted.len() as f32).ceil() as usize).max(2);
    let rows = sorted.windows(sharing);
    let prefixes = rows.map(|row| common_prefix(row[0], row[sharing - 1]));
    prefixes.max_by_key(|prefix| prefix.len()).unwrap_or("")
}

fn common_prefix<'a>(a: &'a str, b: &str) -> &'a str {
    let same = a.char_indices().zip(b.chars());
    let end = same.take_while(|((_, a), b)| a == b).last();
    end.map_or("", |((at, c), _)| &a[..at + c.len_utf8()])
}

fn joint(role: usize, names: &[&str]) -> Option<usize> {
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
