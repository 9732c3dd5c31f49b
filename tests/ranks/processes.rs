//! Ranks as processes that mpiexec starts.

use super::{folder, last, on_ranks, small};
use footwork::gpu::Choice;
use footwork::train::config::Config;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

const PROGRAM: &str = env!("CARGO_BIN_EXE_footwork");

/// mpiexec, told to start so many ranks of a training.
fn mpiexec(count: usize, words: &str) -> Command {
    let mut command = Command::new("mpiexec");
    command.args(["-n", &count.to_string(), PROGRAM, "train"]);
    command.args(words.split_whitespace());
    command.stdin(Stdio::null());
    command
}

/// A configuration as a file, and the words that train by it in a folder.
fn words(config: &Config, folder: &Path, out: &str) -> String {
    let file = folder.join(format!("{out}.toml"));
    std::fs::write(&file, config.to_toml()).unwrap();
    let (task, out) = (&config.task.name, folder.join(out));
    format!(
        "{task} --device cpu --config {} --out {}",
        file.display(),
        out.display()
    )
}

fn told(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn processes_train_as_threads_do_bit_for_bit() {
    let (folder, path) = folder();
    for task in ["plane", "imitate"] {
        let config = Config {
            device: Choice::Cpu,
            ..small(task, 3)
        };
        for count in [1, 2, 4] {
            let out = format!("{task}-{count}");
            let words = words(&config, folder.path(), &out);
            let output = mpiexec(count, &words).output().expect("mpiexec");
            assert!(output.status.success(), "{}", told(&output));
            let threads = format!("{out}-threads");
            let threads = on_ranks(count, &config, Choice::Cpu, &path(&threads));
            assert!(last(&path(&out)).sections == threads.sections, "{out}");
            let summary = std::fs::read_to_string(path(&out).join("summary.json")).unwrap();
            let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
            assert_eq!(summary["ranks"], count);
            assert_eq!(summary["parameters_hash"], threads.policy.hash());
            assert!(summary["communication_share"].as_f64().unwrap() < 1.0);
        }
    }
}

/// Runs something that must be refused in one message of the first rank or of the one that is wrong.
fn refused(command: &mut Command, code: i32, part: &str) {
    let start = Instant::now();
    let output = command.output().expect("mpiexec");
    let told = told(&output);
    assert!(told.contains(part), "{told}");
    assert_eq!(told.matches("error: ").count(), 1, "{told}");
    assert_eq!(output.status.code(), Some(code), "{told}");
    assert!(start.elapsed() < Duration::from_secs(60));
}

#[test]
fn ranks_that_cannot_train_together_are_refused() {
    let (folder, path) = folder();
    let out = path("run").display().to_string();
    let config = small("plane", 1);
    let words = words(&config, folder.path(), "run");
    refused(
        &mut mpiexec(3, &words),
        2,
        "3 ranks cannot share 16 environments",
    );
    refused(
        &mut mpiexec(2, &format!("{words} --envs 1")),
        2,
        "2 ranks cannot share 1 environments",
    );
    let mut other = mpiexec(1, &words);
    other.args([":", "-n", "1", PROGRAM, "train"]);
    other.args(words.split_whitespace()).args(["--seed", "2"]);
    refused(
        &mut other,
        1,
        "rank 1: another configuration than the first rank's",
    );
    let mut eval = Command::new("mpiexec");
    eval.args(["-n", "2", PROGRAM, "eval", &out]);
    let output = eval.output().unwrap();
    assert!(
        told(&output).contains("leave out mpiexec"),
        "{}",
        told(&output)
    );
    assert!(!path("run").exists(), "a refused training leaves nothing");
}

/// Processes that run the program in a folder.
fn ranks_in(folder: &Path) -> Vec<u32> {
    let processes = std::fs::read_dir("/proc").unwrap().filter_map(Result::ok);
    let numbers = processes.filter_map(|entry| entry.file_name().to_str()?.parse().ok());
    let folder = folder.display().to_string();
    let is_rank = |number: &u32| {
        let file = |name: &str| format!("/proc/{number}/{name}");
        let words = std::fs::read_to_string(file("cmdline")).unwrap_or_default();
        let program = std::fs::read_link(file("exe"));
        program.is_ok_and(|path| path == Path::new(PROGRAM)) && words.contains(&folder)
    };
    numbers.filter(is_rank).collect()
}

fn wait_until(child: &mut Child, limit: Duration) -> bool {
    let start = Instant::now();
    while start.elapsed() < limit {
        if child.try_wait().unwrap().is_some() {
            return true;
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    false
}

/// `FOOTWORK_KILLS` asks for more than a few.
#[test]
fn a_rank_that_dies_ends_all_and_the_run_goes_on() {
    let kills = std::env::var("FOOTWORK_KILLS").map_or(2, |kills| kills.parse().unwrap());
    let (folder, path) = folder();
    let config = Config {
        checkpoint_every: 256,
        ..small("plane", 1 << 20)
    };
    let mut command = mpiexec(2, &words(&config, folder.path(), "run"));
    for kill in 0..kills {
        let mut child = command
            .stderr(Stdio::null())
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        let start = Instant::now();
        while !path("run/config.toml").exists() || ranks_in(folder.path()).len() < 2 {
            assert!(
                start.elapsed() < Duration::from_secs(60),
                "it does not begin"
            );
            std::thread::sleep(Duration::from_millis(10));
        }
        std::thread::sleep(Duration::from_millis(100 + kill * 7919 % 1500));
        let ranks = ranks_in(folder.path());
        let victim = ranks[kill as usize % ranks.len()].to_string();
        assert!(
            Command::new("kill")
                .args(["-9", &victim])
                .status()
                .unwrap()
                .success()
        );
        assert!(
            wait_until(&mut child, Duration::from_secs(5)),
            "kill {kill}"
        );
        assert!(ranks_in(folder.path()).is_empty(), "kill {kill}");
        let steps = last(&path("run")).header.steps;
        let run = path("run").display().to_string();
        let more = format!("plane --resume {run} --steps {}", steps + 128);
        let output = mpiexec(2, &more).output().unwrap();
        assert!(output.status.success(), "{}", told(&output));
        assert_eq!(last(&path("run")).header.steps, steps + 128);
        command = mpiexec(2, &format!("plane --resume {run} --steps {}", 1u64 << 40));
    }
}
