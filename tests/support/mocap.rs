//! The folder of real recordings: the one that `FOOTWORK_MOCAP` names, else `../shared/mocap` beside the
//! checkout.

use std::env::var_os;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::thread;

/// A folder or file among the recordings. Where there is none, a line on stderr names the test that is
/// skipped.
///
/// # Panics
/// There is none, and `FOOTWORK_REQUIRE_MOCAP` is set.
pub fn recordings(inside: &str) -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/mocap");
    let path = var_os("FOOTWORK_MOCAP")
        .map_or(beside, PathBuf::from)
        .join(inside);
    if path.exists() {
        return Some(path);
    }
    let path = path.display();
    let required = var_os("FOOTWORK_REQUIRE_MOCAP").is_some();
    assert!(
        !required,
        "no recordings at {path}, and FOOTWORK_REQUIRE_MOCAP is set"
    );
    // Not through `eprintln`, which the test runner keeps to itself.
    let test = thread::current();
    let test = test.name().unwrap_or("a test");
    let line = format!("SKIPPED {test}: no recordings at {path} (set FOOTWORK_MOCAP)\n");
    std::io::stderr()
        .write_all(line.as_bytes())
        .expect("stderr");
    None
}
