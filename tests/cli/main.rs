//! The program as its user meets it: options, messages, exit codes, files.

#[cfg(target_os = "linux")]
mod accidents;
mod auto;
mod bench;
mod boxing;
#[cfg(unix)]
mod damaged;
mod data;
mod export;
#[path = "../support/low_level.rs"]
mod low_level;
#[path = "../support/mocap.rs"]
mod mocap;
mod obstacles;
#[cfg(unix)]
mod places;
#[path = "../support/python.rs"]
mod python;
mod refused;
mod render;
mod sim;
mod skills;
mod stand;
mod steering;
#[cfg(unix)]
mod stopped;
mod style;
mod sweep;
mod train;
#[cfg(target_os = "linux")]
mod window;

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

/// A folder of its own to run the program in.
struct Place(TempDir);

impl Place {
    fn new() -> Self {
        Place(tempfile::tempdir().unwrap())
    }

    /// With three minutes of synthetic motion in `small.footwork`.
    fn with_data() -> Self {
        let place = Place::new();
        place.done("data synth --minutes 3 --out small.footwork");
        place
    }

    /// With the run `run` of 8192 steps besides.
    fn with_run() -> Self {
        let place = Place::with_data();
        place.done(&format!("{TRAIN} --steps 8192 --out run"));
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, contents: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), contents).unwrap();
    }

    fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap()
    }

    fn json(&self, name: &str) -> Value {
        serde_json::from_str(&self.read(name)).unwrap()
    }

    /// The program with words as arguments, in this folder.
    fn command(&self, words: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_footwork"));
        command.current_dir(self.0.path()).stdin(Stdio::null());
        command.args(words.split_whitespace());
        command
    }

    fn run(&self, words: &str) -> Told {
        Told::from(words, self.command(words).output().unwrap())
    }

    /// Runs something that must work.
    fn done(&self, words: &str) -> Told {
        let told = self.run(words);
        assert_eq!(told.code, Some(0), "{told:?}");
        told
    }

    /// Everything here and below, sorted.
    fn list(&self) -> Vec<PathBuf> {
        let mut all = Vec::new();
        let mut open = vec![self.0.path().to_path_buf()];
        while let Some(folder) = open.pop() {
            for entry in std::fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    open.push(path.clone());
                }
                all.push(path);
            }
        }
        all.sort();
        all
    }

    /// Runs something that must be refused in one message, and leave nothing behind.
    fn refused(&self, words: &str, code: i32, parts: &[&str]) {
        let before = self.list();
        self.run(words).is_refusal(code, parts);
        assert_eq!(self.list(), before, "{words}");
    }
}

/// What the program answered.
#[derive(Debug)]
struct Told {
    #[expect(dead_code, reason = "shown where a test fails")]
    words: String,
    code: Option<i32>,
    out: String,
    err: String,
}

impl Told {
    fn from(words: &str, output: Output) -> Self {
        Told {
            words: words.to_string(),
            code: output.status.code(),
            out: String::from_utf8(output.stdout).unwrap(),
            err: String::from_utf8(output.stderr).unwrap(),
        }
    }

    /// One message with all `parts`, none of which is said twice.
    fn is_refusal(&self, code: i32, parts: &[&str]) {
        assert_eq!(self.code, Some(code), "{self:?}");
        assert!(!self.err.contains("panicked"), "{self:?}");
        let errors = self.err.lines().filter(|line| line.starts_with("error: "));
        assert_eq!(errors.count(), 1, "{self:?}");
        for part in parts {
            assert!(self.err.contains(part), "no `{part}` in {self:?}");
        }
        let told_twice = parts
            .first()
            .is_some_and(|part| self.err.matches(part).count() > 1);
        assert!(!told_twice, "{self:?}");
    }
}

/// A short training on the CPU; what is missing are steps and folder.
const TRAIN: &str = "train plane --data small.footwork --device cpu --envs 64";

/// The rows of a run's `metrics.jsonl`.
fn rows(run: &Path) -> Vec<Value> {
    let text = std::fs::read_to_string(run.join("metrics.jsonl")).unwrap();
    let rows = text.lines().map(serde_json::from_str);
    rows.collect::<Result<_, _>>().unwrap()
}

fn keys(object: &Value) -> Vec<&str> {
    let object = object.as_object().unwrap();
    object.keys().map(String::as_str).collect()
}
