//! Good trainings and their evaluation: what is written, what is printed, what is repeated.

use super::{Place, TRAIN, keys, rows};
use footwork::container::Sections;
use footwork::train::checkpoint::Checkpoint;
use serde_json::Value;

fn last(place: &Place, run: &str) -> Checkpoint {
    let path = place.path(run).join("checkpoints/last.ckpt");
    Checkpoint::load(&path).unwrap()
}

/// Everything a checkpoint holds but the time it took.
fn state(place: &Place, run: &str) -> Sections {
    last(place, run).sections
}

/// A run's metrics but for the times.
fn metrics(place: &Place, run: &str) -> Vec<Value> {
    let mut rows = rows(&place.path(run));
    for row in &mut rows {
        let row = row.as_object_mut().unwrap();
        row.retain(|key, _| !key.ends_with("_s"));
    }
    rows
}

#[test]
fn a_run_folder_holds_all_that_is_promised() {
    let place = Place::with_data();
    let told = place.done(&format!("{TRAIN} --steps 24576 --seed 5 --out run"));
    for name in [
        "config.toml",
        "events.out.tfevents.footwork",
        "learning_curve.png",
        "trajectories.png",
        "checkpoints/last.ckpt",
        "checkpoints/best.ckpt",
        "checkpoints/steps-0000020000.ckpt",
    ] {
        let file = place.path("run").join(name).metadata();
        assert!(file.is_ok_and(|file| file.len() > 0), "{name}");
    }
    let summary = place.json("run/summary.json");
    for key in [
        "steps",
        "wall_s",
        "steps_per_s",
        "success",
        "device",
        "seed",
        "stopped_by",
        "time_to_target_mean_s",
        "version",
    ] {
        assert!(keys(&summary).contains(&key), "no {key} in {summary}");
    }
    assert_eq!(
        (&summary["steps"], &summary["seed"]),
        (&24576.into(), &5.into())
    );
    assert_eq!(summary["stopped_by"], "steps");
    assert!(summary["device"].as_str().unwrap().starts_with("cpu"));

    let rows = rows(&place.path("run"));
    assert_eq!(rows.len(), 24);
    for (update, row) in (1..).zip(&rows) {
        assert_eq!(row["steps"], 1024 * update);
        for key in [
            "policy_loss",
            "value_loss",
            "kl",
            "clip_fraction",
            "explained_variance",
            "entropy",
            "steps_per_s",
            "policy_s",
            "env_s",
            "learn_s",
            "wall_s",
            "learning_rate",
        ] {
            assert!(row[key].is_f64(), "{key} in {row}");
        }
        for key in ["episode_return", "episode_length", "success"] {
            assert!(
                row[key].is_f64() || row["episodes"] == 0.0,
                "{key} in {row}"
            );
        }
    }
    // Piped: plain lines, and the result alone on stdout.
    assert!(!told.err.contains(['\r', '\u{1b}']), "{told:?}");
    assert!(told.err.contains("1024 steps  success"), "{told:?}");
    assert!(told.out.starts_with("24576 steps in "), "{told:?}");
}

#[test]
fn a_run_is_evaluated() {
    let place = Place::with_run();
    let told = place.done("eval run --json");
    let report: Value = serde_json::from_str(&told.out).unwrap();
    assert!(told.err.is_empty(), "{told:?}");
    for key in [
        "episodes",
        "success",
        "time_to_target_mean_s",
        "time_to_target_p95_s",
        "path_ratio",
        "mean_speed",
    ] {
        assert!(report[key].is_number(), "no {key} in {report}");
    }
    assert_eq!(report["episodes"], 1000);
    assert_eq!(report["success"], place.json("run/summary.json")["success"]);

    let again = place.done("eval run/checkpoints/last.ckpt --json");
    assert_eq!(again.out, told.out);

    let told = place.done("eval run --episodes 50 --baseline --json");
    let report: Value = serde_json::from_str(&told.out).unwrap();
    let baseline = report["baseline"].as_array().unwrap();
    assert!(
        baseline.len() > 4
            && baseline
                .iter()
                .all(|row| row["success"].as_f64() > Some(0.9))
    );
    let table = place.done("eval run --episodes 50 --baseline").out;
    assert!(
        table.contains("policy ") && table.contains("straight at 4 m/s"),
        "{table}"
    );
}

#[test]
fn limits_stop_a_training() {
    let place = Place::with_data();
    place.write("run.toml", "evaluate_every = 1024");
    for (limit, by) in [
        ("--max-time 500ms", "time"),
        ("--stop-at-success 0.01", "success"),
    ] {
        let words = format!("{TRAIN} --config run.toml --steps 100000000 {limit} --out {by}");
        place.done(&words);
        assert_eq!(place.json(&format!("{by}/summary.json"))["stopped_by"], by);
    }
}

#[test]
fn runs_without_names_and_data_get_them() {
    let place = Place::new();
    let words = "train plane --device cpu --envs 16 --steps 256";
    let told = place.done(words);
    assert!(told.err.contains("synthetic motion"), "{told:?}");
    place.done(words);
    for run in ["runs/plane-1", "runs/plane-2"] {
        assert!(place.path(run).join("summary.json").exists());
    }
}

#[test]
fn a_seed_gives_one_result_and_a_stop_does_not_change_it() {
    let place = Place::with_data();
    place.write("run.toml", "evaluate_every = 2048\ncheckpoint_every = 4096");
    let train = |rest: &str| place.done(&format!("{TRAIN} --config run.toml {rest}"));
    train("--steps 16384 --out whole");
    train("--steps 16384 --out again");
    train("--steps 16384 --out other --seed 2");
    train("--steps 8192 --out halves");
    place.done("train plane --resume halves --steps 16384");
    let whole = state(&place, "whole");
    assert_eq!(last(&place, "whole").header.steps, 16384);
    assert!(whole == state(&place, "again"));
    assert!(whole == state(&place, "halves"));
    assert!(whole != state(&place, "other"));
    assert_eq!(metrics(&place, "whole"), metrics(&place, "halves"));
    assert_eq!(place.json("halves/summary.json")["steps"], 16384);
}

/// On the GPU path too.
#[test]
fn a_seed_gives_one_result_on_lavapipe() {
    let place = Place::with_data();
    let text = "checkpoint_every = 512\n[ppo]\nrollout_length = 8\nminibatch_size = 128";
    place.write("run.toml", text);
    let train = |rest: &str| {
        place.done(&format!(
            "train plane --data small.footwork --device lavapipe --envs 64 --config run.toml {rest}"
        ))
    };
    train("--steps 2048 --out whole");
    train("--steps 2048 --out again");
    train("--steps 1024 --out halves");
    place.done("train plane --resume halves --steps 2048");
    let whole = state(&place, "whole");
    assert!(whole == state(&place, "again"));
    assert!(whole == state(&place, "halves"));
}

#[test]
fn a_database_made_with_other_weights_keeps_them() {
    let place = Place::new();
    place.done("data synth --minutes 3 --weights holden --out small.footwork");
    let told = place.done(&format!("{TRAIN} --steps 1024 --out run"));
    assert!(told.err.contains("other weights"), "{told:?}");
    assert!(
        place
            .read("run/config.toml")
            .contains("foot_position = 0.75")
    );
}

#[test]
fn any_key_can_be_set() {
    let place = Place::with_data();
    let set = "--set ppo.gamma=0.9 --set task.success_radius=1 --set ppo.network.hidden=[8] --set device=cpu";
    place.done(&format!(
        "train plane --data small.footwork --envs 16 --steps 256 {set} --out run"
    ));
    let config = place.read("run/config.toml");
    for line in [
        "gamma = 0.9",
        "success_radius = 1.0",
        "hidden = [8]",
        "device = \"cpu\"",
        "name = \"plane\"",
    ] {
        assert!(config.contains(line), "no {line} in {config}");
    }
    // A run's configuration makes another such run.
    place.done("train plane --config run/config.toml --out again");
    assert_eq!(place.read("again/config.toml"), config);
}
