//! Arrows between modules go down only, and there are no circles: read from the imports in `src`.
//!
//! The order of the top-level modules is [`ORDER`]. The files and subfolders of a folder, and the file
//! that declares them (`mod.rs`), must not use each other in a circle; exporting an item again is no
//! use. Tests inside `src` are left out.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Top-level modules from the roof to the ground; those of a line do not know each other.
const ORDER: [&[&str]; 14] = [
    &["cli", "capi", "prelude"],
    &["viewer", "web"],
    &["bench", "export"],
    &["view"],
    &["runtime"],
    &["train"],
    &["rl"],
    &["env"],
    &["nn", "matching"],
    &["kernels"],
    &["physics", "playback"],
    &["motion"],
    &["ranks"],
    &["gpu"],
];
/// Modules beside the order: everybody may use them, and they know none of the others.
const BESIDE: [&str; 3] = ["report", "container", "input_file"];

#[test]
fn arrows_between_top_level_modules_go_down() {
    let sources = Sources::read();
    let upward = sources.arrows().into_iter().filter(|arrow| {
        let (from, to) = (&arrow.from[0], &arrow.to[0]);
        from != to && !may_use(from, to)
    });
    let found: Vec<String> = upward.map(|arrow| arrow.to_string()).collect();
    assert!(found.is_empty(), "upward arrows:\n{}", found.join("\n"));
}

fn may_use(from: &str, to: &str) -> bool {
    let rank = |name: &str| ORDER.iter().position(|line| line.contains(&name));
    match (rank(from), rank(to)) {
        (Some(from), Some(to)) => from < to,
        (_, None) => BESIDE.contains(&to) && (from != "container" || to == "input_file"),
        (None, Some(_)) => false,
    }
}

#[test]
fn every_top_level_module_has_its_place_in_the_order() {
    let sources = Sources::read();
    let modules = sources.files.keys().filter_map(|module| module.first());
    let unknown: BTreeSet<&String> = modules
        .filter(|name| !ORDER.concat().contains(&&***name) && !BESIDE.contains(&&***name))
        .collect();
    assert!(unknown.is_empty(), "{unknown:?}");
}

#[test]
fn no_modules_of_a_folder_use_each_other_in_a_circle() {
    let sources = Sources::read();
    // By folder, from one of its members to another. A folder's own file is the member "".
    let mut folders: BTreeMap<Vec<String>, BTreeMap<[String; 2], Arrow>> = BTreeMap::new();
    for arrow in sources.arrows() {
        let common = common(&arrow.from, &arrow.to);
        let member = |path: &[String]| path.get(common).cloned().unwrap_or_default();
        let ends = [member(&arrow.from), member(&arrow.to)];
        if common > 0 && ends[0] != ends[1] {
            let folder = folders.entry(arrow.from[..common].to_vec()).or_default();
            folder.entry(ends).or_insert(arrow);
        }
    }
    let found: Vec<String> = folders.values().flat_map(circles).collect();
    assert!(found.is_empty(), "circles:\n{}", found.join("\n"));
}

fn common(a: &[String], b: &[String]) -> usize {
    a.iter().zip(b).take_while(|(a, b)| a == b).count()
}

/// The arrows that are part of a circle: their start can be reached from their end.
fn circles(arrows: &BTreeMap<[String; 2], Arrow>) -> Vec<String> {
    let reaches = |from: &String, to: &String| {
        let (mut seen, mut open) = (BTreeSet::new(), vec![from]);
        while let Some(at) = open.pop() {
            if seen.insert(at) {
                let next = arrows.keys().filter(|ends| ends[0] == *at);
                open.extend(next.map(|ends| &ends[1]));
            }
        }
        seen.contains(to)
    };
    let circular = arrows
        .iter()
        .filter(|(ends, _)| reaches(&ends[1], &ends[0]));
    circular.map(|(_, arrow)| arrow.to_string()).collect()
}

/// An import: `file:line` of the module `from` names something of the module `to`.
struct Arrow {
    file: String,
    line: usize,
    from: Vec<String>,
    to: Vec<String>,
}

impl std::fmt::Display for Arrow {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let [from, to] = [&self.from, &self.to].map(|path| path.join("::"));
        write!(f, "src/{}:{}: {from} -> {to}", self.file, self.line)
    }
}

/// A path as it is written, and whether it is exported again.
struct Import {
    line: usize,
    path: Vec<String>,
    exported: bool,
}

struct File {
    name: String,
    imports: Vec<Import>,
}

/// All files by their module's path.
struct Sources {
    files: BTreeMap<Vec<String>, File>,
}

impl Sources {
    fn read() -> Self {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
        let mut names = Vec::new();
        list(&root, "", &mut names);
        let mut texts = BTreeMap::new();
        for name in names {
            let text = std::fs::read_to_string(root.join(&name)).expect("a source");
            texts.insert(module_of(&name), (name, text));
        }
        // The crate's own root stands above all: what it declares is no arrow.
        texts.remove(&Vec::new());
        let modules: Vec<Vec<String>> = texts.keys().cloned().collect();
        let parse = |(module, (name, text)): (Vec<String>, (String, String))| {
            let children = modules
                .iter()
                .filter(|other| other.len() == module.len() + 1 && other.starts_with(&module));
            let children: BTreeSet<&str> = children.map(|child| &**child.last().unwrap()).collect();
            let imports = imports(&production(&text), &children);
            (module, File { name, imports })
        };
        let files = texts.into_iter().map(parse).collect();
        Sources { files }
    }

    /// What a file names of other files.
    fn arrows(&self) -> Vec<Arrow> {
        let mut arrows = Vec::new();
        for (module, file) in &self.files {
            for import in &file.imports {
                let Some(to) = self.resolve(module, &import.path) else {
                    continue;
                };
                // What a folder's file exports of its members is no use of them.
                let own = import.exported && to.starts_with(module);
                if to != *module && !own {
                    arrows.push(Arrow {
                        file: file.name.clone(),
                        line: import.line,
                        from: module.clone(),
                        to,
                    });
                }
            }
        }
        arrows
    }

    /// The module that defines what `path` names in `module`.
    fn resolve(&self, module: &[String], path: &[String]) -> Option<Vec<String>> {
        let (mut at, mut rest) = match path[0].as_str() {
            "crate" | "footwork" => (Vec::new(), &path[1..]),
            "self" => (module.to_vec(), &path[1..]),
            "super" => {
                let up = path.iter().take_while(|part| *part == "super").count();
                (
                    module[..module.len().checked_sub(up)?].to_vec(),
                    &path[up..],
                )
            }
            _ => (module.to_vec(), path),
        };
        while let [first, others @ ..] = rest {
            let child = [&at[..], std::slice::from_ref(first)].concat();
            if !self.files.contains_key(&child) {
                break;
            }
            (at, rest) = (child, others);
        }
        let item = rest.first();
        match item.and_then(|item| self.exported(&at, item)) {
            Some(to) => Some(to),
            None => (!at.is_empty()).then_some(at),
        }
    }

    /// The module out of which `module` exports an item again.
    fn exported(&self, module: &[String], item: &str) -> Option<Vec<String>> {
        let file = self.files.get(module)?;
        let exports = file.imports.iter().filter(|import| import.exported);
        let mut named =
            exports.filter(|import| import.path.last().is_some_and(|last| last == item));
        self.resolve(module, &named.next()?.path)
    }
}

/// All Rust files below a folder.
fn list(root: &Path, inside: &str, names: &mut Vec<String>) {
    for entry in std::fs::read_dir(root.join(inside)).expect("a folder") {
        let entry = entry.expect("an entry");
        let name = entry.file_name().into_string().expect("a name");
        let name = if inside.is_empty() {
            name
        } else {
            format!("{inside}/{name}")
        };
        if entry.path().is_dir() {
            list(root, &name, names);
        } else if name.ends_with(".rs") {
            names.push(name);
        }
    }
}

/// `a::b` of `a/b.rs` and of `a/b/mod.rs`.
fn module_of(name: &str) -> Vec<String> {
    let name = name.trim_end_matches(".rs");
    let name = name.strip_suffix("/mod").unwrap_or(name);
    match name {
        "lib" | "main" => Vec::new(),
        _ => name.split('/').map(str::to_string).collect(),
    }
}

/// A source without its tests, comments and literals, line by line as it was.
fn production(text: &str) -> String {
    let text = text.split("\n#[cfg(test)]\nmod ").next().unwrap_or(text);
    let chars: Vec<char> = text.chars().collect();
    let mut out = String::new();
    let mut at = 0;
    while at < chars.len() {
        let end = match (chars[at], chars.get(at + 1)) {
            ('/', Some('/')) => until(&chars, at, |rest| rest[0] == '\n'),
            ('"', _) if out.ends_with("r#") => {
                until(&chars, at + 1, |rest| rest.starts_with(&['"', '#'])) + 2
            }
            ('"', _) => string_end(&chars, at),
            ('\'', Some('\\')) => until(&chars, at + 3, |rest| rest[0] == '\'') + 1,
            ('\'', Some(_)) if chars.get(at + 2) == Some(&'\'') => at + 3,
            _ => {
                out.push(chars[at]);
                at += 1;
                continue;
            }
        };
        let end = end.min(chars.len());
        out.extend(chars[at..end].iter().filter(|&&c| c == '\n'));
        at = end;
    }
    out
}

fn until(chars: &[char], from: usize, stop: impl Fn(&[char]) -> bool) -> usize {
    (from..chars.len())
        .find(|&at| stop(&chars[at..]))
        .unwrap_or(chars.len())
}

/// Behind the string that begins here.
fn string_end(chars: &[char], from: usize) -> usize {
    let mut at = from + 1;
    while at < chars.len() && chars[at] != '"' {
        at += if chars[at] == '\\' { 2 } else { 1 };
    }
    at + 1
}

/// The paths of `use` statements, and those that are named where they are used.
fn imports(text: &str, children: &BTreeSet<&str>) -> Vec<Import> {
    let mut found = Vec::new();
    let mut rest = String::new();
    let (mut from, mut statements) = (0, Vec::new());
    while let Some(begin) = find_word(text, "use", from) {
        let end = text[begin..]
            .find(';')
            .map_or(text.len(), |end| begin + end);
        statements.push((begin, end));
        from = end;
    }
    let mut last = 0;
    for (begin, end) in statements {
        let line = text[..begin].matches('\n').count() + 1;
        let before = text[..begin].trim_end();
        let exported = before.ends_with("pub") || before.ends_with(')');
        for path in expand(&text[begin + 3..end]) {
            if local(&path[0], children) {
                found.push(Import {
                    line,
                    path,
                    exported,
                });
            }
        }
        rest.push_str(&text[last..begin]);
        rest.extend(text[begin..end].chars().filter(|&c| c == '\n'));
        last = end;
    }
    rest.push_str(&text[last..]);
    for (number, line) in rest.lines().enumerate() {
        for path in paths(line) {
            if path.len() > 1 && local(&path[0], children) {
                let line = number + 1;
                found.push(Import {
                    line,
                    path,
                    exported: false,
                });
            }
        }
    }
    found
}

fn local(first: &str, children: &BTreeSet<&str>) -> bool {
    ["crate", "super", "self", "footwork"].contains(&first) || children.contains(first)
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

fn find_word(text: &str, word: &str, from: usize) -> Option<usize> {
    let found = text[from..].match_indices(word).map(|(at, _)| from + at);
    let mut alone = found.filter(|&at| {
        !text[..at].ends_with(is_word) && !text[at + word.len()..].starts_with(is_word)
    });
    alone.next()
}

/// The paths of a tree of imports.
fn expand(tree: &str) -> Vec<Vec<String>> {
    let tree = tree.trim();
    let Some((head, group)) = tree.split_once('{') else {
        return vec![parts_of(tree.split(" as ").next().unwrap_or(tree))];
    };
    let head = parts_of(head);
    let group = group.trim_end().trim_end_matches('}');
    let (mut depth, mut begin, mut parts) = (0, 0, Vec::new());
    for (at, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                parts.push(&group[begin..at]);
                begin = at + 1;
            }
            _ => {}
        }
    }
    parts.push(&group[begin..]);
    let parts = parts.into_iter().filter(|part| !part.trim().is_empty());
    let paths = parts.flat_map(|part| match part.trim() {
        "self" => vec![Vec::new()],
        part => expand(part),
    });
    paths.map(|path| [&head[..], &path[..]].concat()).collect()
}

fn parts_of(path: &str) -> Vec<String> {
    let parts = path.split("::").map(|part| part.trim().to_string());
    parts.filter(|part| !part.is_empty()).collect()
}

/// The paths `a::b::c` of a line.
fn paths(line: &str) -> Vec<Vec<String>> {
    let words = line.split(|c: char| !is_word(c) && c != ':');
    let paths = words.map(|word| {
        let parts = word.split("::").map(str::to_string);
        parts.collect::<Vec<_>>()
    });
    paths
        .filter(|path| !path[0].is_empty() && !path[0].contains(':'))
        .collect()
}
