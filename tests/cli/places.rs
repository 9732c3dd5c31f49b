//! Places that cannot be written to, and disks that fill up.

use super::{Place, TRAIN, Told};
use std::process::Command;

#[test]
fn nothing_is_made_where_nothing_can_be() {
    let place = Place::with_data();
    place.done("data synth --minutes 1 --out synth.footwork --bvh walk");
    // A file is no folder, whoever asks; `/proc` takes no files.
    for out in ["small.footwork/x", "gone/x", "walk", "/proc/x", "/dev/null"] {
        let parts = &["cannot write ", out];
        place.refused(&format!("data import walk --out {out}"), 1, parts);
        place.refused(
            &format!("data synth --minutes 1 --out {out} --bvh b"),
            1,
            parts,
        );
    }
    let null = std::fs::metadata("/dev/null").unwrap();
    assert!(!null.is_file());
    for out in ["small.footwork", "small.footwork/x", "/proc/x"] {
        let words = format!("{TRAIN} --steps 1024 --out {out}");
        place.refused(&words, 1, &["cannot make the run folder", out]);
    }
    for picture in ["small.footwork/x.png", "/proc/x.png", "walk"] {
        let words = format!("data info small.footwork --plot {picture}");
        place.refused(&words, 1, &["cannot write the picture", picture]);
    }
}

#[test]
fn a_run_is_not_overwritten() {
    let place = Place::with_run();
    let words = format!("{TRAIN} --steps 1024 --out run");
    place.refused(&words, 1, &["run already holds a run", "--resume"]);
}

/// Runs the program with files that cannot grow beyond `blocks` of 512 bytes: writing fails
/// midway, as on a full disk.
fn run_cramped(place: &Place, blocks: u32, words: &str) -> Told {
    let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" \"$@\"");
    let mut command = Command::new("sh");
    command.current_dir(place.path("")).arg("-c").arg(script);
    command.arg(env!("CARGO_BIN_EXE_footwork"));
    Told::from(
        words,
        command.args(words.split_whitespace()).output().unwrap(),
    )
}

#[test]
fn a_full_disk_leaves_no_part_of_a_file() {
    let place = Place::with_data();
    let before = place.list();
    let told = run_cramped(&place, 100, "data synth --minutes 1 --out new.footwork");
    told.is_refusal(1, &["cannot write new.footwork", "free space"]);
    let told = run_cramped(&place, 10, "data info small.footwork --plot new.png");
    told.is_refusal(1, &["cannot write the picture new.png"]);
    let told = run_cramped(&place, 0, &format!("{TRAIN} --steps 1024 --out run"));
    told.is_refusal(1, &["cannot write run/"]);
    assert_eq!(place.list(), before);

    // An older file stays as it was.
    let good = std::fs::read(place.path("small.footwork")).unwrap();
    let told = run_cramped(&place, 100, "data synth --minutes 1 --out small.footwork");
    told.is_refusal(1, &["cannot write small.footwork"]);
    assert!(std::fs::read(place.path("small.footwork")).unwrap() == good);
}

#[test]
fn a_disk_that_fills_up_ends_a_training_with_a_summary() {
    let place = Place::with_data();
    // Room for a checkpoint, but not for the metrics of so many updates.
    let words = format!("{TRAIN} --steps 400000 --out run");
    let told = run_cramped(&place, 250, &words);
    told.is_refusal(1, &["cannot write run/metrics.jsonl"]);
    assert!(
        told.err.contains("without events for TensorBoard"),
        "{told:?}"
    );
    let summary = place.json("run/summary.json");
    assert_eq!(summary["stopped_by"], "failure");
    for path in place.list() {
        let name = path.file_name().unwrap().to_string_lossy();
        assert!(!name.starts_with(".footwork-"), "{name}");
    }
    // What was saved goes on.
    let steps = summary["steps"].as_u64().unwrap() + 1024;
    place.done(&format!("train plane --resume run --steps {steps}"));
    let rows = super::rows(&place.path("run"));
    assert_eq!(rows.len() as u64, steps / 1024);
}
