//! What happens to a program while it runs: readers that go away, full disks, two of it at once, moved data.

use super::{Place, TRAIN, Told, rows};
use std::fs::File;
use std::process::Stdio;

/// Runs with stdout into something.
fn into(place: &Place, words: &str, stdout: impl Into<Stdio>) -> Told {
    let child = place
        .command(words)
        .stdout(stdout)
        .stderr(Stdio::piped())
        .spawn();
    Told::from(words, child.unwrap().wait_with_output().unwrap())
}

/// A pipe whose reader is gone.
fn closed_pipe() -> std::io::PipeWriter {
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    writer
}

#[test]
fn readers_that_go_away_end_nothing() {
    let place = Place::with_run();
    for words in [
        "data info small.footwork",
        "eval run --episodes 5 --json",
        "train --help",
    ] {
        let told = into(&place, words, closed_pipe());
        assert_eq!((told.code, told.err.as_str()), (Some(0), ""), "{told:?}");
    }
    let words = format!("{TRAIN} --steps 8192 --out unread");
    let child = place
        .command(&words)
        .stdout(closed_pipe())
        .stderr(closed_pipe())
        .spawn();
    assert_eq!(child.unwrap().wait().unwrap().code(), Some(0));
    assert_eq!(place.json("unread/summary.json")["steps"], 8192);
}

#[test]
fn a_full_disk_is_an_error_with_a_name() {
    let place = Place::with_run();
    let full = || File::options().write(true).open("/dev/full").unwrap();
    let told = into(&place, "eval run --episodes 5 --json", full());
    told.is_refusal(1, &["cannot write to standard output"]);
    // Nothing depends on who reads the progress.
    let words = format!("{TRAIN} --steps 8192 --out unread");
    let child = place
        .command(&words)
        .stdout(Stdio::null())
        .stderr(full())
        .spawn();
    assert_eq!(child.unwrap().wait().unwrap().code(), Some(0));
}

/// Without its events a training is as good as before.
#[test]
fn events_that_cannot_be_written_stop_nothing() {
    let place = Place::with_run();
    let events = place.path("run/events.out.tfevents.footwork");
    std::fs::remove_file(&events).unwrap();
    std::os::unix::fs::symlink("/dev/full", &events).unwrap();
    let told = place.done("train plane --resume run --steps 10240");
    assert!(
        told.err.contains("goes on without events for TensorBoard"),
        "{told:?}"
    );
    assert_eq!(rows(&place.path("run")).len(), 10);
}

#[test]
fn trainings_that_start_at_once_have_folders_of_their_own() {
    let place = Place::with_data();
    let start = |seed: u32| {
        let words = format!("{TRAIN} --steps 1024 --seed {seed}");
        place
            .command(&words)
            .stderr(Stdio::null())
            .stdout(Stdio::null())
            .spawn()
            .unwrap()
    };
    let children: Vec<_> = (1..=8).map(start).collect();
    for mut child in children {
        assert_eq!(child.wait().unwrap().code(), Some(0));
    }
    for run in 1..=8 {
        assert_eq!(
            rows(&place.path(&format!("runs/plane-{run}"))).len(),
            1,
            "{run}"
        );
    }
}

#[test]
fn a_run_is_written_by_one_process_alone() {
    let place = Place::with_run();
    let held = File::options()
        .write(true)
        .open(place.path("run/run.lock"))
        .unwrap();
    held.try_lock().unwrap();
    let part = "run is being written by process";
    for words in [
        "train plane --resume run --steps 10240",
        "train plane --out run",
    ] {
        place.refused(words, 1, &[part]);
    }
    // Reading is free.
    place.done("eval run --episodes 5");
    drop(held);
    place.write("run/.footwork-abcdef", "half");
    place.write("run/checkpoints/.footwork-abcdef", "half");
    place.done("train plane --resume run --steps 10240");
    assert!(!place.path("run/.footwork-abcdef").exists());
    assert!(!place.path("run/checkpoints/.footwork-abcdef").exists());
}

#[test]
fn moved_data_is_named_and_the_run_goes_on() {
    let place = Place::with_run();
    std::fs::rename(place.path("small.footwork"), place.path("moved.footwork")).unwrap();
    let resume = "train plane --resume run --steps 10240";
    place.refused(
        resume,
        1,
        &["is gone: it was", "say where it is now with --data"],
    );
    place.done(&format!("{resume} --data moved.footwork"));
    // Remembered from then on.
    place.done("train plane --resume run --steps 12288");
    place.done("data synth --minutes 3 --seed 2 --out other.footwork");
    let other = "train plane --resume run --steps 20480 --data other.footwork";
    place.refused(other, 1, &["was trained with other data"]);
}

#[test]
fn a_run_goes_on_from_any_of_its_checkpoints() {
    let place = Place::with_data();
    place.write("often.toml", "checkpoint_every = 2048");
    place.done(&format!(
        "{TRAIN} --config often.toml --steps 8192 --out run"
    ));
    let last = std::fs::read(place.path("run/checkpoints/last.ckpt")).unwrap();
    place.done("train plane --resume run/checkpoints/steps-0000004096.ckpt --steps 8192");
    assert_eq!(rows(&place.path("run")).len(), 8);
    assert!(std::fs::read(place.path("run/checkpoints/last.ckpt")).unwrap() == last);
}

#[test]
fn a_time_that_is_over_is_said() {
    let place = Place::with_data();
    place.done(&format!(
        "{TRAIN} --steps 1000000000 --max-time 1s --out run"
    ));
    let part = "is all that --max-time gave it";
    place.refused("train plane --resume run", 2, &[part]);
    place.refused("train plane --resume run --max-time 1s", 2, &[part]);
    place.done("train plane --resume run --max-time 2s");
}

/// In a cage of address space, so that the machine is not touched.
#[test]
fn too_many_environments_are_refused_before_anything_is_made() {
    let place = Place::with_data();
    let before = place.list();
    for words in [
        "train plane --data small.footwork --device cpu --envs 1048576 --steps 1 --out run",
        "train imitate --device cpu --envs 1048576 --steps 1 --out run",
        "sim --envs 1048576 --seconds 0.01 --device cpu",
    ] {
        let mut command = std::process::Command::new("sh");
        command
            .current_dir(place.path(""))
            .args(["-c", "ulimit -v 3145728; exec \"$0\" \"$@\""]);
        command
            .arg(env!("CARGO_BIN_EXE_footwork"))
            .args(words.split_whitespace());
        let told = Told::from(words, command.output().unwrap());
        told.is_refusal(1, &["of memory and", "use a smaller --envs"]);
    }
    assert_eq!(place.list(), before);
}
