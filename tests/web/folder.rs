//! The folder of a page.

use crate::PLANE;
use footwork::nn::Policy;
use footwork::train::config::Preset;
use footwork::train::tasks;
use footwork::web::folder::RunFiles;
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;

const MODULE: &[u8] = b"\0asm";

fn files() -> RunFiles {
    let entry = tasks::find("plane").expect("a task");
    let config = entry.config(Preset::Fast);
    let spec = entry.check(&config).expect("a preset");
    let network = &config.ppo.network;
    let policy = Policy::new(network, &spec.observation, spec.action, 1).expect("a network");
    RunFiles::of_locomotion("plane", 7, &policy, &PLANE).expect("files")
}

fn names(folder: &Path) -> BTreeSet<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let names = entries.map(|entry| entry.expect("an entry").file_name());
    names.map(|name| name.to_string_lossy().into()).collect()
}

#[test]
fn the_folder_holds_what_its_manifest_says() {
    let place = tempfile::tempdir().expect("a folder");
    let out = place.path().join("deep/page");
    let bytes = files().write(&out, MODULE, false).expect("a page");
    let text = std::fs::read_to_string(out.join("page.json")).expect("a manifest");
    let manifest: Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(
        (&manifest["task"], &manifest["steps"]),
        (&"plane".into(), &7.into())
    );
    let parts = manifest["parts"].as_array().expect("parts");
    assert!(parts.len() > 1);
    for entry in parts.iter().chain([&manifest["module"], &manifest["run"]]) {
        let file = out.join(entry["file"].as_str().expect("a name"));
        let len = std::fs::metadata(file).expect("a file").len();
        assert_eq!(entry["bytes"], len);
    }
    let all = names(&out);
    let sizes = all
        .iter()
        .map(|name| out.join(name).metadata().expect("a file").len());
    assert_eq!(sizes.sum::<u64>(), bytes as u64);
    for name in [
        "index.html",
        "main.js",
        "shaders.json",
        "footwork.wasm",
        "run.footwork",
    ] {
        assert!(all.contains(name), "{name} is not in {all:?}");
    }
    assert_eq!(
        names(&place.path().join("deep")).len(),
        1,
        "nothing unfinished is left"
    );
    // Whoever serves it need not be who wrote it.
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let mode = |path: &Path| path.metadata().expect("a file").permissions().mode();
        let readable = mode(&out.join("page.json")) & 0o444;
        assert_eq!(mode(&out) & 0o444, readable);
    }
}

#[test]
fn what_is_there_is_left_unless_it_is_a_page_and_that_is_forced() {
    let place = tempfile::tempdir().expect("a folder");
    let files = files();
    let refused = |out: &Path, forced: bool| {
        let written = files.write(out, MODULE, forced);
        written.expect_err("something is there").to_string()
    };
    let other = place.path().join("other");
    std::fs::create_dir(&other).expect("a folder");
    std::fs::write(other.join("thesis.tex"), "years").expect("a file");
    assert!(refused(&other, true).contains("holds other things than a page"));
    assert!(refused(&other.join("thesis.tex"), true).contains("no folder"));
    assert_eq!(names(&other).len(), 1);
    let page = place.path().join("page");
    std::fs::create_dir(&page).expect("an empty folder is filled");
    files.write(&page, MODULE, false).expect("a page");
    std::fs::write(page.join("motion-999.footwork"), "old").expect("a file");
    assert!(refused(&page, false).contains("--force"));
    files.write(&page, MODULE, true).expect("another page");
    assert!(!names(&page).contains("motion-999.footwork"));
}

#[test]
#[cfg(unix)]
fn the_module_is_as_old_as_its_sources() {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("web/build");
    let checked = std::process::Command::new(script).arg("--check").output();
    let checked = checked.expect("a shell");
    assert!(
        checked.status.success(),
        "{}",
        String::from_utf8_lossy(&checked.stderr)
    );
}
