//! Sweeps: grids of trainings, what they leave, how they go on, and what is refused of them.

use super::{Place, keys, rows};
use serde_json::Value;

const SWEEP: &str = "sweep plane --data small.footwork --device cpu --envs 64";
const GRID: &str = "--set ppo.gamma=0.9,0.99 --set ppo.network.hidden=[16,16],[32]";

#[test]
fn a_sweep_trains_every_combination_and_keeps_what_is_finished() {
    let place = Place::with_data();
    let words = format!("{SWEEP} {GRID} --steps 2048 --seeds 2");
    let told = place.done(&words);
    let lines: Vec<&str> = told.out.lines().collect();
    let names = [
        "gamma=0.9 hidden=[16, 16]",
        "gamma=0.9 hidden=[32]",
        "gamma=0.99 hidden=[16, 16]",
        "gamma=0.99 hidden=[32]",
    ];
    for title in ["success %", "\u{b1}", "training s", "steps/s"] {
        assert!(lines[0].contains(title), "no {title} in {told:?}");
    }
    for (line, name) in lines[2..].iter().zip(names) {
        assert!(line.starts_with(name), "{line}");
    }
    assert_eq!(lines[6], "see runs/plane-sweep");
    assert!(place.path("runs/plane-sweep/sweep.png").exists());
    let text = place.read("runs/plane-sweep/evaluation.csv");
    assert!(text.contains("\n\"gamma=0.9 hidden=[16, 16]\",1,1000,"));
    assert_eq!(text.lines().count(), 9);

    let found = place.json("runs/plane-sweep/sweep.json");
    let variants = found["variants"].as_array().unwrap();
    for (variant, name) in variants.iter().zip(names) {
        assert_eq!(variant["name"], name);
        assert!(variant["success_spread"].is_number(), "{variant}");
        let runs = variant["runs"].as_array().unwrap();
        for (seed, run) in (1..).zip(runs) {
            assert_eq!((&run["seed"], &run["steps"]), (&seed.into(), &2048.into()));
            let folder = run["folder"].as_str().unwrap();
            let folder = place.path("runs/plane-sweep").join(folder);
            assert_eq!(rows(&folder).len(), 2);
        }
    }
    let settings = serde_json::json!({ "ppo.gamma": 0.9, "ppo.network.hidden": [16, 16] });
    assert_eq!(variants[0]["settings"], settings);
    let config = place.read("runs/plane-sweep/gamma=0.9-hidden=16-16-2/config.toml");
    for line in ["gamma = 0.9", "hidden = [16, 16]", "seed = 2"] {
        assert!(
            config.lines().any(|own| own == line),
            "no {line} in {config}"
        );
    }

    let again = place.done(&words);
    assert_eq!((again.out, again.err.as_str()), (told.out, ""));
    let more = place.done(&words.replace("--seeds 2", "--seeds 3"));
    assert!(more.err.contains("hidden=32-3, 12 of 12"), "{more:?}");
    let fewer = words.replace(" 2048 ", " 1024 ");
    place.refused(&fewer, 1, &["has done 2048 steps, more than are asked for"]);
    let other = "holds a run of another configuration";
    place.refused(&format!("{words} --set ppo.epochs=7"), 1, &[other]);
    let others = "runs/plane-sweep holds other runs, like gamma=";
    place.refused(&words.replace(",0.99", ""), 1, &[others]);
}

#[test]
fn trainings_at_once_learn_what_they_learn_one_by_one() {
    let place = Place::with_data();
    let words = format!("{SWEEP} --set ppo.gamma=0.9,0.99 --seeds 2 --steps 2048");
    place.done(&format!("{words} --out one"));
    let told = place.done(&format!("{words} --jobs 3 --out three"));
    assert!(told.err.contains("gamma=0.9-1:  "), "{told:?}");
    for run in ["gamma=0.9-1", "gamma=0.9-2", "gamma=0.99-1", "gamma=0.99-2"] {
        let [one, three] = ["one", "three"].map(|out| place.sections(&format!("{out}/{run}")));
        assert!(one == three, "{run}");
    }
    // As a training of the same choices does.
    let train = "train plane --data small.footwork --device cpu --envs 64";
    place.done(&format!(
        "{train} --set ppo.gamma=0.99 --seed 2 --steps 2048 --out alone"
    ));
    assert!(place.sections("alone") == place.sections("three/gamma=0.99-2"));
}

#[test]
fn a_training_that_fails_is_shown_and_leaves_the_others_alone() {
    let place = Place::with_data();
    let words = format!("{SWEEP} --set ppo.gamma=0.9,0.99 --seeds 2 --steps 1024 --out sweep");
    let obstacle = place.path("sweep/gamma=0.9-1/metrics.jsonl");
    std::fs::create_dir_all(&obstacle).unwrap();
    let told = place.run(&words);
    told.is_refusal(1, &["1 of 4 trainings failed", "the same command"]);
    assert!(told.out.contains("failed"), "{told:?}");
    let found = place.json("sweep/sweep.json");
    let failed = &found["variants"][0]["runs"][0];
    assert!(
        failed["failure"]
            .as_str()
            .unwrap()
            .contains("metrics.jsonl")
    );
    assert!(told.out.contains("gamma=0.9-1 failed: cannot write"));
    assert_eq!(place.read("sweep/evaluation.csv").lines().count(), 4);

    std::fs::remove_dir(&obstacle).unwrap();
    let told = place.done(&words);
    assert!(!told.out.contains("failed"), "{told:?}");
    assert_eq!(place.read("sweep/evaluation.csv").lines().count(), 5);
}

#[cfg(unix)]
#[test]
fn an_interrupted_sweep_goes_on_with_the_same_command() {
    use super::stopped::{signal, wait_for};
    use std::process::Stdio;
    let place = Place::with_data();
    let grid = "--set ppo.gamma=0.9,0.99 --seeds 1 --jobs 2";
    let words = format!("{SWEEP} {grid} --steps 65536 --out sweep");
    let mut command = place.command(&words);
    let command = command.stdout(Stdio::piped()).stderr(Stdio::null());
    let mut child = command.spawn().unwrap();
    wait_for(&place.path("sweep/gamma=0.9-1/config.toml"));
    let status = signal(&mut child, "INT");
    assert_eq!(status.code(), Some(0));
    let mut out = String::new();
    std::io::Read::read_to_string(&mut child.stdout.unwrap(), &mut out).unwrap();
    assert_eq!(out, "go on with the same command\nsee sweep\n");
    let begun = rows(&place.path("sweep/gamma=0.9-1"));

    let told = place.done(&words);
    assert!(told.out.contains("gamma=0.99"), "{told:?}");
    let whole = rows(&place.path("sweep/gamma=0.9-1"));
    assert_eq!((whole.len(), &whole[..begun.len()]), (64, &begun[..]));
}

#[test]
fn a_training_that_reached_its_goal_is_finished() {
    let place = Place::with_data();
    let goal = "--set stop_at_success=0.01 --set evaluate_every=1024";
    let words = format!("{SWEEP} {goal} --seeds 1 --steps 65536");
    place.done(&words);
    let path = "runs/plane-sweep/plane-1/summary.json";
    let summary = place.json(path);
    assert_eq!(summary["stopped_by"], "success", "{summary}");
    assert_eq!(place.done(&words).err, "");
    assert_eq!(place.json(path), summary);
}

#[test]
fn the_measure_of_the_task_is_named() {
    let place = Place::new();
    let small = "--device cpu --envs 4 --set ppo.rollout_length=4 --steps 16";
    let told = place.done(&format!("sweep stand {small} --seeds 1"));
    assert!(told.out.contains("survival %"), "{told:?}");
    let found = place.json("runs/stand-sweep/sweep.json");
    let run: &Value = &found["variants"][0]["runs"][0];
    assert_eq!(found["success_name"], "survival");
    assert_eq!(found["variants"][0]["success_mean"], run["survival"]);
    assert!(keys(run).contains(&"uprightness"), "{run}");
}

#[test]
fn sweeps_that_make_no_sense_are_refused() {
    let place = Place::with_data();
    for (options, part) in [
        ("--set ppo.gama=0.9,0.99", "mean `ppo.gamma`?"),
        ("--set ppo.gamma", "a key, `=` and values"),
        ("--set ppo.gamma=0.9,,0.99", "there is a value missing"),
        ("--set ppo.gamma=", "there is a value missing"),
        ("--set ppo.gamma=0.9,high", "must be of the type float"),
        ("--set ppo.gamma=0.9,2", "ppo.gamma is 2"),
        ("--set ppo.gamma=0.9,0.90", "come to the same"),
        (
            "--set ppo.gamma=0.9 --set ppo.gamma=0.99",
            "--set ppo.gamma is given twice",
        ),
        (
            "--set ppo.network.hidden=[16],[0]",
            "has a layer of width 0",
        ),
        ("--set seed=1,2", "--seeds says how many"),
        (
            "--set data=a,b",
            "--set data: all trainings of a sweep share",
        ),
        (
            "--set task.weights.foot_position=1,2",
            "task.weights.foot_position: all trainings of a sweep share",
        ),
        ("--set preset=fast,paper", "--set preset"),
        ("--seeds 0", "--seeds must be from 1 to 100"),
        ("--seeds 101", "--seeds must be from 1 to 100"),
        ("--jobs 0", "--jobs must be at least 1"),
        ("--jobs -1", "invalid value '-1' for '--jobs"),
        (
            "--seeds 100 --set ppo.epochs=1,2,3,4,5,6,7,8,9,10,11",
            "these are 1100 trainings",
        ),
    ] {
        place.refused(&format!("{SWEEP} {options}"), 2, &[part]);
    }
    place.refused("sweep plan", 2, &["similar value exists: 'plane'"]);
}
