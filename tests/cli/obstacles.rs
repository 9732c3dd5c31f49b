//! The task with obstacles, its ablation, and what is refused of them.

use super::{Place, keys, rows};
use serde_json::Value;

/// Small networks: what is tested here is not how well they learn.
const SMALL: &str = "[ppo]\nrollout_length = 16\nminibatch_size = 512\n[ppo.network]\nencoder_hidden = [16]\nhidden = [16]\n";
const TRAIN: &str =
    "train obstacles --data small.footwork --device cpu --envs 64 --config small.toml";

fn place() -> Place {
    let place = Place::with_data();
    place.write("small.toml", SMALL);
    place
}

#[test]
fn a_run_among_obstacles_shows_its_levels_and_its_walks() {
    let place = place();
    place.done(&format!("{TRAIN} --steps 2048 --out run"));
    for name in ["learning_curve.png", "obstacle_walks.png"] {
        assert!(place.path("run").join(name).exists(), "{name}");
    }
    assert_eq!(place.json("run/summary.json")["level"], 0);
    for row in rows(&place.path("run")) {
        assert_eq!(row["level"], 0);
        assert!(row["truncation"].is_number() && row["collision"].is_number());
    }

    let told = place.done("eval run --episodes 40 --json");
    let found: Value = serde_json::from_str(&told.out).unwrap();
    let levels = found["levels"].as_array().unwrap();
    assert_eq!(levels.len(), 10);
    for (level, one) in levels.iter().enumerate() {
        assert_eq!(one["level"], level);
        for key in ["success", "collision", "loiter"] {
            let fraction = one[key].as_f64().unwrap();
            assert!((0.0..=1.0).contains(&fraction), "{key} of {one}");
        }
    }
    assert_eq!(levels[9]["success"], found["success"]);
    assert!(keys(&found).contains(&"time_to_target_p95_s"));

    let told = place.done("eval run --episodes 5 --motion-quality --json");
    let found: Value = serde_json::from_str(&told.out).unwrap();
    for style in ["recorded", "raw", "simple", "stitched", "locked"] {
        let quality = &found["motion"][style];
        assert!(quality["foot_skate_cm_s"].is_number(), "{style}: {quality}");
        assert!(quality["jerk"].is_number(), "{style}: {quality}");
    }
    let told = place.done("eval run --episodes 5 --motion-quality");
    assert!(told.out.contains("stitching and foot locking"));

    let told = place.done("eval run --episodes 20 --baseline");
    assert!(told.out.contains("level") && told.out.contains("straight at 4 m/s"));
}

#[test]
fn options_of_the_task_reach_its_configuration() {
    let place = place();
    let options = "--no-hit-reward --no-curriculum --success-bonus 25";
    place.done(&format!("{TRAIN} {options} --steps 1024 --out run"));
    let config = place.read("run/config.toml");
    for line in [
        "hit_reward = 0.0",
        "curriculum = false",
        "success_bonus = 25.0",
        "count = 100",
    ] {
        assert!(config.contains(line), "no {line} in {config}");
    }
    assert_eq!(place.json("run/summary.json")["level"], 9);
}

#[test]
fn obstacles_that_make_no_sense_are_refused() {
    let place = place();
    for (text, parts) in [
        ("count = -1", &["`task.count` must not be negative"][..]),
        ("side_min = 0", &["task.side_min is 0"]),
        ("side_min = -1", &["task.side_min is -1"]),
        ("side_max = 0.2", &["task.side_max is 0.2"]),
        ("speed = -0.5", &["task.speed is -0.5"]),
        ("speed = nan", &["task.speed is NaN"]),
        ("map_edge_width = -0.1", &["task.map_edge_width is -0.1"]),
        ("map_history_s = 11", &["task.map_history_s is 11"]),
        (
            "arena_half_extent = 2",
            &["task.arena_half_extent is 2", "start cannot be kept clear"],
        ),
        ("success_radius = 3", &["task.success_radius is 3"]),
        (
            "promotion_success = 1.5",
            &["task.promotion_success is 1.5"],
        ),
        ("reward = \"stay\"", &["[task]: unknown variant `stay`"]),
        (
            "success_is_terminal = 1",
            &["`task.success_is_terminal` must be of the type boolean"],
        ),
        (
            "speed_distributoin = \"same\"",
            &["did you mean `task.speed_distribution`"],
        ),
    ] {
        place.write("bad.toml", format!("[task]\n{text}"));
        let train = "train obstacles --data small.footwork --device cpu";
        place.refused(&format!("{train} --config bad.toml --out run"), 2, parts);
    }
    for (text, part) in [
        (
            "size = 17",
            "ppo.network.convolutions has a filter size of 17",
        ),
        (
            "size = 0",
            "ppo.network.convolutions has a filter size of 0",
        ),
        (
            "filters = 1000",
            "ppo.network.convolutions has a number of filters of 1000",
        ),
    ] {
        let rest = ["filters = 8", "size = 4", "stride = 1"];
        let kept = rest
            .iter()
            .filter(|key| key.split(' ').next() != text.split(' ').next());
        let keys: Vec<&str> = kept.copied().chain([text]).collect();
        let list = format!("[ppo.network]\nconvolutions = [{{ {} }}]", keys.join(", "));
        place.write("bad.toml", list);
        let words = "train obstacles --data small.footwork --config bad.toml --out run";
        place.refused(words, 2, &[part]);
    }
    let twice = "{ filters = 8, size = 9, stride = 1 }";
    place.write(
        "bad.toml",
        format!("[ppo.network]\nconvolutions = [{twice}, {twice}]"),
    );
    let words = "train obstacles --data small.footwork --config bad.toml --out run";
    place.refused(
        words,
        2,
        &["ppo.network.convolutions has a filter of 9 x 9 cells over an input of 8 x 8"],
    );
    place.write("bad.toml", "[obstacles]\nreach = 1");
    place.refused(words, 2, &["unknown key `obstacles`"]);
}

#[test]
fn runs_of_one_task_are_not_gone_on_with_as_another() {
    let place = place();
    place.done(&format!("{TRAIN} --steps 1024 --out run"));
    place.refused(
        "train plane --resume run --steps 2048",
        2,
        &["run is a run of the task `obstacles`, not of `plane`"],
    );
    let plane = place
        .done("train plane --data small.footwork --device cpu --envs 64 --steps 1024 --out plane");
    assert!(plane.out.contains("1024 steps"), "{plane:?}");
    place.refused(
        "eval plane --planner 3",
        2,
        &["--planner is for runs among obstacles"],
    );
    // A checkpoint that strayed into the run of another task.
    let stray = std::fs::read(place.path("plane/checkpoints/last.ckpt")).unwrap();
    place.write("run/checkpoints/last.ckpt", stray);
    for words in ["eval run", "train obstacles --resume run --steps 2048"] {
        let parts = ["of the task `plane`, not of `obstacles`"];
        place.refused(words, 1, &parts);
    }
}

#[test]
fn an_ablation_is_written_down_and_goes_on_where_it_was() {
    let place = place();
    let words = |rest: &str| {
        format!(
            "ablate obstacles --data small.footwork --device cpu --envs 64 --config small.toml --out ablation {rest}"
        )
    };
    place.done(&words("--steps 1024 --seeds 1"));
    for name in [
        "ablation.png",
        "ablation.txt",
        "evaluation.csv",
        "curves.csv",
    ] {
        assert!(place.path("ablation").join(name).exists(), "{name}");
    }
    let table = place.read("ablation/ablation.txt");
    for variant in ["full", "no-hit-reward", "no-curriculum"] {
        assert!(table.contains(variant), "{table}");
    }
    assert_eq!(place.read("ablation/evaluation.csv").lines().count(), 4);
    let kept = place.read("ablation/full-1/metrics.jsonl");

    let told = place.done(&words("--steps 1024 --seeds 2"));
    assert!(told.out.contains("no-curriculum"), "{told:?}");
    assert_eq!(place.read("ablation/evaluation.csv").lines().count(), 7);
    assert_eq!(place.read("ablation/full-1/metrics.jsonl"), kept);

    // One that was cut short is finished: its times differ, what it learned does not.
    std::fs::remove_file(place.path("ablation/full-2/checkpoints/last.ckpt")).unwrap();
    place.done(&words("--steps 1024 --seeds 2"));
    assert_eq!(place.read("ablation/evaluation.csv").lines().count(), 7);
    place.refused(
        &words("--steps 1024 --seeds 1").replace("--envs 64", "--envs 32"),
        1,
        &["full-1 holds a run of another configuration"],
    );
    // More steps go on from there; fewer would judge what was not asked for.
    place.done(&words("--steps 2048 --seeds 1"));
    let fewer = words("--steps 1024 --seeds 1");
    place.refused(&fewer, 1, &["full-1 has done 2048 steps"]);
    place.refused(&words("--seeds 0"), 2, &["--seeds must be from 1 to 100"]);
}

#[test]
fn a_batch_that_a_device_cannot_hold_is_refused() {
    let place = place();
    place.refused(
        "train obstacles --data small.footwork --device lavapipe --set ppo.envs=4096 --out run",
        1,
        &["observations of an update take 265 MiB", "smaller --envs"],
    );
}
