//! The tasks with a discriminator: trainings, their evaluation, and what they refuse.

use super::{Place, keys, rows};
use serde_json::Value;

const SMALL_PPO: &str =
    "--device cpu --envs 16 --set ppo.rollout_length=8 --set ppo.minibatch_size=64";
const SMALL: &str = "--device cpu --envs 16 --set ppo.rollout_length=8 --set ppo.minibatch_size=64 \
                     --set amp.minibatch_size=32 --set amp.replay_capacity=256 \
                     --set amp.replay_per_update=64 --set amp.steps=2";

#[test]
fn bodies_learn_a_style_and_are_evaluated() {
    let place = Place::new();
    for (task, own) in [
        ("imitate", ["survival", "speed_ratio", "style", "coverage"]),
        ("punch", ["survival", "hit_rate", "fist_rate", "coverage"]),
        (
            "joystick",
            [
                "heading_error_deg",
                "speed_error",
                "facing_error_deg",
                "dtw_m",
            ],
        ),
        (
            "track",
            ["survival", "root_error_m", "key_error_m", "dtw_m"],
        ),
    ] {
        let small = if task == "track" { SMALL_PPO } else { SMALL };
        let told = place.done(&format!("train {task} {small} --steps 256 --out {task}"));
        assert!(told.err.contains("synthetic motion"), "{told:?}");
        assert!(place.path(task).join("learning_curve.png").exists());
        for row in rows(&place.path(task)) {
            let style = ["style_reward", "recorded_accuracy", "agent_accuracy"];
            for key in style.into_iter().filter(|_| task != "track") {
                assert!(keys(&row).contains(&key), "no {key} in {row}");
            }
        }
        let found = place.done(&format!("eval {task} --episodes 4 --json")).out;
        let found: Value = serde_json::from_str(&found).unwrap();
        for key in own {
            assert!(keys(&found).contains(&key), "no {key} in {found}");
        }
        place.done(&format!("render {task} --out {task}.png"));
    }
    // What has learned to move begins a task, and only that.
    place.done(&format!(
        "train punch {SMALL} --steps 128 --from imitate --task-weight pd --out begun"
    ));
    let [begun, imitate] = ["begun", "imitate"].map(|run| rows(&place.path(run)));
    assert_eq!((begun.len(), imitate.len()), (1, 2));
    let style = imitate
        .iter()
        .map(|row| row["style_reward"].as_f64().unwrap());
    let (reference, mean) = (&begun[0]["style_reference"], style.sum::<f64>() / 2.0);
    assert!((reference.as_f64().unwrap() - 0.8 * mean).abs() < 1e-6);
    place.refused(
        &format!("train punch {SMALL} --set ppo.network.hidden=[64] --from imitate --out wrong"),
        1,
        &["cannot begin with the one given by --from"],
    );
    place.refused(
        "train punch --resume imitate --steps 512",
        2,
        &["is a run of the task `imitate`"],
    );
}

/// Trains without a stop and with one. Returns the metrics.
fn resumed(options: &str) -> Vec<Value> {
    let place = Place::new();
    place.done(&format!("train punch {options} --steps 768 --out whole"));
    place.done(&format!("train punch {options} --steps 384 --out halves"));
    place.done("train punch --resume halves --steps 768");
    let [whole, halves] = ["whole", "halves"].map(|run| {
        let path = place.path(run).join("checkpoints/last.ckpt");
        let checkpoint = footwork::train::checkpoint::Checkpoint::load(&path);
        checkpoint.unwrap().sections
    });
    assert!(whole == halves, "{options}");
    rows(&place.path("whole"))
}

#[test]
fn a_style_goes_on_where_it_was() {
    let rows = resumed(SMALL);
    assert!(!keys(&rows[0]).contains(&"task_weight"));
}

#[test]
fn a_weight_that_looks_after_itself_goes_on_where_it_was() {
    let pd = format!("{SMALL} --task-weight pd --set task_weight.style_reference=0.6");
    let first = ["cpu", "lavapipe"].map(|device| {
        let rows = resumed(&pd.replace("--device cpu", &format!("--device {device}")));
        let of = |row: &Value, key: &str| row[key].as_f64().unwrap();
        for row in &rows {
            let lambda = of(row, "lambda");
            assert!((0.5..=3.0).contains(&lambda), "{row}");
            assert!((of(row, "task_weight") - lambda / (1.0 + lambda)).abs() < 1e-6);
            assert!((of(row, "style_reference") - 0.6).abs() < 1e-6);
        }
        let moved = rows
            .windows(2)
            .all(|pair| pair[0]["lambda"] != pair[1]["lambda"]);
        assert!(moved, "{rows:?}");
        of(&rows[0], "style_reward")
    });
    assert!((first[0] - first[1]).abs() < 1e-2, "{first:?}");
}

#[test]
fn what_a_style_cannot_be_is_refused() {
    let place = Place::with_data();
    std::fs::write(place.path("empty.toml"), "").unwrap();
    std::fs::write(place.path("gone.toml"), "[[clip]]\nfile = \"gone.bvh\"\n").unwrap();
    std::fs::write(
        place.path("light.toml"),
        "[[clip]]\nfile = \"gone.bvh\"\nweight = 0.0\n",
    )
    .unwrap();
    for (rest, part) in [
        ("--data empty.toml", "empty.toml"),
        ("--data gone.toml", "gone.bvh"),
        ("--data light.toml", "weight"),
        ("--set amp.heads=0", "amp.heads is 0"),
        ("--set amp.hidden=[5000]", "width 5000"),
        ("--set amp.style_weight=0.0", "amp.style_weight is 0"),
        ("--set amp.loss=square", "square"),
        ("--set amp.head=3", "did you mean `amp.heads`"),
    ] {
        let words = format!("train imitate {SMALL} {rest} --out run");
        let told = place.run(&words);
        assert_ne!(told.code, Some(0), "{words}: {told:?}");
        assert!(told.err.contains(part), "{words}: {told:?}");
        assert!(!place.path("run").exists(), "{words} left a folder");
    }
    for (rest, part) in [
        ("--set task.distance=[9.0,2.0]", "the smaller first"),
        ("--set task.near_share=2.0", "near_share"),
        ("--set task.far=somehow", "somehow"),
    ] {
        place.refused(&format!("train punch {SMALL} {rest} --out run"), 2, &[part]);
    }
    for (task, rest, parts) in [
        (
            "plane",
            "--task-weight pd",
            ["task_weight.rule is pd", "`plane`"],
        ),
        (
            "imitate",
            "--task-weight pd",
            ["task_weight.rule is pd", "`imitate`"],
        ),
        (
            "punch",
            "--task-weight pd --set amp.loss=hinge",
            ["task_weight.rule is pd", "hinge"],
        ),
        (
            "punch",
            "--task-weight pd --set amp.task_weight=0",
            ["task_weight.rule is pd", "but one"],
        ),
        ("punch", "--task-weight bd", ["invalid value", "fixed, pd"]),
        (
            "punch",
            "--set task_weight.rule=bd",
            ["`bd`", "`fixed` or `pd`"],
        ),
        (
            "punch",
            "--set task_weight.style_reference=-0.1",
            ["task_weight.style_reference is -0.1", "between"],
        ),
        (
            "punch",
            "--set task_weight.style_reference=nan",
            ["task_weight.style_reference is NaN", "between"],
        ),
    ] {
        place.refused(&format!("train {task} {rest} --out run"), 2, &parts);
    }
    place.refused(
        "train plane --ground --out run",
        2,
        &["takes no motion list"],
    );
    place.refused(
        "train plane --set amp.heads=3 --out run",
        2,
        &["unknown key `amp`"],
    );
}
