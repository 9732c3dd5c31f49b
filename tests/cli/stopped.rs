//! Trainings that are stopped from outside go on later.

use super::{Place, TRAIN, rows};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// An endless training that saves every 1024 steps, once it has saved.
fn start(place: &Place) -> Child {
    place.write("run.toml", "checkpoint_every = 1024");
    let words = format!("{TRAIN} --config run.toml --steps 100000000 --out run");
    let mut command = place.command(&words);
    let child = command
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    // It comes after the first checkpoint.
    wait_for(&place.path("run/config.toml"));
    child
}

pub fn wait_for(file: &Path) {
    let begin = Instant::now();
    while !file.exists() {
        assert!(begin.elapsed() < Duration::from_secs(60), "nothing saved");
        std::thread::sleep(Duration::from_millis(20));
    }
}

pub fn signal(child: &mut Child, name: &str) -> ExitStatus {
    let pid = child.id().to_string();
    let sent = Command::new("kill")
        .args([&format!("-{name}"), &pid])
        .status();
    assert!(sent.unwrap().success());
    child.wait().unwrap()
}

/// Steps of the last checkpoint.
fn saved(place: &Place) -> u64 {
    let path = place.path("run/checkpoints/last.ckpt");
    let checkpoint = footwork::train::checkpoint::Checkpoint::load(&path).unwrap();
    checkpoint.header.steps
}

/// Goes on for two updates; the metrics must have each update once.
fn goes_on(place: &Place) {
    let steps = saved(place) + 2048;
    place.done(&format!("train plane --resume run --steps {steps}"));
    assert_eq!(saved(place), steps);
    let rows = rows(&place.path("run"));
    assert_eq!(rows.len() as u64, steps / 1024);
    for (update, row) in (1..).zip(rows) {
        assert_eq!(row["update"], update);
    }
    place.done("eval run --episodes 20");
}

#[test]
fn an_interrupted_run_saves_and_goes_on() {
    let place = Place::with_data();
    for name in ["INT", "TERM"] {
        let mut child = start(&place);
        let status = signal(&mut child, name);
        assert_eq!(status.code(), Some(0), "{name}");
        let summary = place.json("run/summary.json");
        assert_eq!(summary["stopped_by"], "interrupt");
        assert_eq!(summary["steps"], saved(&place));
        goes_on(&place);
        std::fs::remove_dir_all(place.path("run")).unwrap();
    }
}

#[test]
fn a_killed_run_goes_on_from_its_last_checkpoint() {
    let place = Place::with_data();
    let mut child = start(&place);
    let status = signal(&mut child, "KILL");
    assert_eq!(status.code(), None);
    assert!(!place.path("run/summary.json").exists());
    goes_on(&place);
}
