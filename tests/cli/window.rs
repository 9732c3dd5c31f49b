//! Windows, on a display of their own (Xvfb).

use super::{Place, TRAIN};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A virtual display that goes when this does.
struct Display {
    server: Child,
    name: String,
}

impl Display {
    fn open() -> Display {
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", "1024x768x24"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("Xvfb (Debian and Ubuntu: apt install xvfb)");
        let mut number = String::new();
        let out = server.stdout.take().unwrap();
        std::io::BufRead::read_line(&mut std::io::BufReader::new(out), &mut number).unwrap();
        let name = format!(":{}", number.trim());
        Display { server, name }
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        // It may be gone already.
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// The program with a window, running.
fn start(place: &Place, display: &Display, words: &str) -> Child {
    let mut command = place.command(words);
    command
        .env("DISPLAY", &display.name)
        .env_remove("WAYLAND_DISPLAY");
    command
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

/// Waits; `None` if it still runs.
fn ended(child: &mut Child, within: Duration) -> Option<i32> {
    let begin = Instant::now();
    while begin.elapsed() < within {
        if let Some(status) = child.try_wait().unwrap() {
            return Some(status.code().unwrap_or(-1));
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    None
}

/// A short training of a simulated body.
const BODY: &str = "--envs 16 --set ppo.rollout_length=8 --set ppo.minibatch_size=64 \
                    --set amp.minibatch_size=32 --set amp.replay_capacity=256 \
                    --set amp.replay_per_update=64 --set amp.steps=2 --steps 512";

#[test]
fn simulated_bodies_are_watched_and_played() {
    let (place, display) = (Place::new(), Display::open());
    for (task, device) in [
        ("imitate", "cpu"),
        ("punch", "cpu"),
        ("imitate", "lavapipe"),
    ] {
        let run = format!("{task}-{device}");
        let words = format!("train {task} {BODY} --device {device} --watch --out {run}");
        let mut child = start(&place, &display, &words);
        let code = ended(&mut child, Duration::from_secs(300));
        let told = complaint(child);
        assert_eq!(code, Some(0), "{told}");
        // A software rasteriser that trains as well may be too busy for a window.
        assert!(device != "cpu" || !told.contains("unwatched"), "{told}");
        assert_eq!(place.json(&format!("{run}/summary.json"))["steps"], 512);
    }
    for run in ["imitate-cpu", "punch-cpu"] {
        let words = format!("play {run}");
        let mut child = start(&place, &display, &words);
        let code = ended(&mut child, Duration::from_secs(8));
        let told = complaint(child);
        assert_eq!(code, None, "{words}: {told}");
        assert!(
            !told.contains("error:") && !told.contains("panicked"),
            "{told}"
        );
    }
}

fn complaint(mut child: Child) -> String {
    // It may have ended by itself.
    let _ = child.kill();
    let output = child.wait_with_output().unwrap();
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn windows_stay_open() {
    let (place, display) = (Place::with_run(), Display::open());
    for words in [
        "play run",
        "play run --follow",
        "play --data small.footwork",
    ] {
        let mut child = start(&place, &display, words);
        let code = ended(&mut child, Duration::from_secs(5));
        let told = complaint(child);
        assert_eq!(code, None, "{words}: {told}");
        assert!(
            !told.contains("error:") && !told.contains("panicked"),
            "{told}"
        );
    }
}

#[test]
fn a_watched_training_ends_as_any_other() {
    let (place, display) = (Place::with_data(), Display::open());
    for (device, run) in [("cpu", "native"), ("lavapipe", "shaders")] {
        let train = TRAIN.replace("--device cpu", &format!("--device {device}"));
        let words = format!("{train} --steps 8192 --watch --out {run}");
        let mut child = start(&place, &display, &words);
        let code = ended(&mut child, Duration::from_secs(120));
        assert_eq!(code, Some(0), "{}", complaint(child));
        assert_eq!(place.json(&format!("{run}/summary.json"))["steps"], 8192);
    }
    // Watching changes nothing.
    place.done(&format!("{TRAIN} --steps 8192 --out alone"));
    let load = |run: &str| {
        let path = place.path(run).join("checkpoints/last.ckpt");
        footwork::train::checkpoint::Checkpoint::load(&path).unwrap()
    };
    assert!(load("native").sections == load("alone").sections);
}

#[test]
fn without_a_display_says_so() {
    let place = Place::with_run();
    let blind = |words: &str| {
        let mut command = place.command(words);
        command
            .env_remove("DISPLAY")
            .env_remove("WAYLAND_DISPLAY")
            .env_remove("WAYLAND_SOCKET");
        super::Told::from(words, command.output().unwrap())
    };
    blind("play run").is_refusal(1, &["no display", "footwork render"]);
    // A training is worth more than its window.
    let told = blind(&format!("{TRAIN} --steps 1024 --watch --out blind"));
    assert_eq!(told.code, Some(0), "{told:?}");
    assert!(told.err.contains("unwatched"), "{told:?}");
}
