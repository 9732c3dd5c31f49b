//! High levels: trainings that steer a low level, their evaluation, and what they refuse.

use super::low_level::checkpoint;
use super::{Place, keys, rows};
use footwork::env::humanoid::task::spec;
use footwork::physics::scenes;
use footwork::rl::ase::LowLevel;
use footwork::train::checkpoint::Checkpoint;
use serde_json::Value;

const SMALL: &str = "--device cpu --envs 16 --set ppo.rollout_length=4 --set ppo.minibatch_size=32";

impl Place {
    /// With a low level in the run folder `low`, of a body that observes so many numbers of itself.
    pub fn with_low_level(style: usize) -> Place {
        let place = Place::new();
        place.put_low_level(style, 1);
        place
    }

    fn put_low_level(&self, style: usize, seed: u32) {
        std::fs::create_dir_all(self.path("low/checkpoints")).unwrap();
        self.write("low/config.toml", "");
        let action = spec(&scenes::humanoid(), 0, 1).action;
        let low_level = checkpoint(LowLevel::Ase, style, &vec![0.0; action], seed);
        low_level
            .save(&self.path("low/checkpoints/last.ckpt"))
            .unwrap();
    }

    pub fn sections(&self, run: &str) -> footwork::container::Sections {
        let path = self.path(run).join("checkpoints/last.ckpt");
        Checkpoint::load(&path).unwrap().sections
    }
}

/// Numbers that the body observes of itself.
const STYLE: usize = 105;

#[test]
fn skills_are_steered_and_evaluated() {
    let place = Place::with_low_level(STYLE);
    for (task, low) in [("punch", "low"), ("joystick", "low/checkpoints/last.ckpt")] {
        let told = place.done(&format!(
            "train {task} --skills {low} {SMALL} --steps 128 --out {task}"
        ));
        assert!(told.err.contains("skills of 6 numbers"), "{told:?}");
        let config = place.read(&format!("{task}/config.toml"));
        let named = format!("skills = \"{}\"", place.path(low).display());
        assert!(config.contains(&named), "{config}");
        assert!(!config.contains("[amp]"), "{config}");
        for row in rows(&place.path(task)) {
            assert!(keys(&row).contains(&"style_reward"), "{row}");
            assert!(!keys(&row).contains(&"agent_accuracy"), "{row}");
        }
        assert!(place.path(task).join("learning_curve.png").exists());
    }
    // A rule for the weights keeps to the style.
    place.done(&format!(
        "train punch --skills low {SMALL} --task-weight pd --steps 128 --out pd"
    ));
    for row in rows(&place.path("pd")) {
        let lambda = row["lambda"].as_f64().unwrap();
        assert!((0.5..=3.0).contains(&lambda), "{row}");
    }
    let found = place.done("eval punch --episodes 4 --json").out;
    let found: Value = serde_json::from_str(&found).unwrap();
    for key in ["hit_rate", "survival", "style"] {
        assert!(keys(&found).contains(&key), "no {key} in {found}");
    }
    place.done("render punch --out punch.png");
    let small = SMALL.replace("--device cpu", "--device cpu --seeds 1");
    place.done(&format!(
        "compare punch --skills low {small} --steps 320 --out both"
    ));
    let table = place.read("both/comparison.txt");
    assert!(
        table.contains("direct") && table.contains("steered"),
        "{table}"
    );
    assert!(place.path("both/comparison.png").exists());
}

#[test]
fn a_high_level_goes_on_where_it_was_unless_its_low_level_changed() {
    let place = Place::with_low_level(STYLE);
    let begun = format!("train punch --skills low {SMALL}");
    place.done(&format!("{begun} --steps 256 --out whole"));
    place.done(&format!("{begun} --steps 128 --out halves"));
    place.done("train punch --resume halves --steps 256");
    assert!(place.sections("whole") == place.sections("halves"));
    // Moved, it is asked for; named anew, it is found.
    std::fs::rename(place.path("low"), place.path("moved")).unwrap();
    let gone = place.path("low");
    let gone = format!("it was {}", gone.display());
    let gone = gone.as_str();
    for command in [
        "eval whole --episodes 4",
        "train punch --resume whole --steps 384",
    ] {
        place.refused(command, 1, &[gone, "--skills", "low level"]);
    }
    place.done("eval whole --episodes 4 --skills moved");
    place.done("train punch --resume whole --steps 320 --skills moved");
    place.done("eval whole --episodes 4");
    // Changed, it is another.
    place.put_low_level(STYLE, 2);
    for command in [
        "eval whole --episodes 4 --skills low",
        "train punch --resume whole --steps 384 --skills low",
    ] {
        place.refused(command, 1, &["another low level", "--skills"]);
    }
}

#[test]
fn what_cannot_be_steered_is_refused() {
    let place = Place::with_low_level(STYLE);
    place.done(
        "train stand --device cpu --envs 4 --set ppo.rollout_length=4 --steps 16 --out stand",
    );
    for (words, part) in [
        ("train imitate --skills low --out run", "leave out `skills`"),
        ("train plane --skills low --out run", "leave out `skills`"),
        (
            "train punch --skills nowhere --out run",
            "nowhere is not a run folder",
        ),
        (
            "train punch --skills stand --out run",
            "is of the task `stand`, not of `skills`",
        ),
        (
            "train punch --skills low --set amp.heads=2 --out run",
            "unknown key `amp`",
        ),
        ("train punch --set skills=low --out run", "--skills"),
        ("eval stand --episodes 4 --skills low", "leave out --skills"),
        ("eval stand --episodes 4 --skills", "which has no skills"),
    ] {
        place.refused(words, 2, &[part]);
    }
    place.done(&format!(
        "train skills {SMALL} --set amp.loss=hinge --steps 64 --out hinge"
    ));
    place.refused(
        "train punch --skills hinge --task-weight pd --out run",
        2,
        &["task_weight.rule is pd", "hinge"],
    );
    place.put_low_level(STYLE - 1, 1);
    place.refused(
        "train punch --skills low --out run",
        2,
        &["does not fit", "104"],
    );
    place.write("low/checkpoints/last.ckpt", "nothing");
    place.refused(
        "train punch --skills low --out run",
        2,
        &["is not a footwork checkpoint"],
    );
}
