//! The task of the simulated body: a training, its evaluation, its picture, and what it refuses.

use super::{Place, keys, rows};
use serde_json::Value;

const TRAIN: &str =
    "train stand --device cpu --envs 16 --set ppo.rollout_length=8 --set ppo.minibatch_size=64";

#[test]
fn a_simulated_body_is_trained_and_evaluated() {
    let place = Place::new();
    let told = place.done(&format!("{TRAIN} --steps 256 --out run"));
    assert!(told.out.contains("episodes stay up for 10 s"), "{told:?}");
    assert!(place.path("run/learning_curve.png").exists());
    assert_eq!(rows(&place.path("run")).len(), 2);

    let found = place.done("eval run --episodes 5 --json").out;
    let found: Value = serde_json::from_str(&found).unwrap();
    for key in [
        "episodes",
        "survival",
        "episode_length_mean_s",
        "uprightness",
    ] {
        assert!(keys(&found).contains(&key), "no {key} in {found}");
    }
    place.done("render run --out strip.png");
    place.done("render run --out film.gif --seconds 0.5 --size 64x64");
    assert!(place.path("film.gif").exists());
    for (words, part) in [
        ("eval run --baseline", "--baseline is for motion matching"),
        ("eval run --planner 3", "--planner is for motion matching"),
    ] {
        place.refused(words, 2, &[part]);
    }
}

#[test]
fn a_simulated_body_goes_on_where_it_was() {
    let place = Place::new();
    place.done(&format!("{TRAIN} --steps 512 --out whole"));
    place.done(&format!("{TRAIN} --steps 256 --out halves"));
    place.done("train stand --resume halves --steps 512");
    let [whole, halves] = ["whole", "halves"].map(|run| {
        let path = place.path(run).join("checkpoints/last.ckpt");
        let checkpoint = footwork::train::checkpoint::Checkpoint::load(&path);
        checkpoint.unwrap().sections
    });
    assert!(whole == halves);
}

#[test]
fn choices_that_a_simulated_body_does_not_have_are_refused() {
    let place = Place::with_data();
    for (rest, part) in [
        ("--data small.footwork", "uses no motion"),
        ("--no-hit-reward", "unknown key `task.hit_reward`"),
        (
            "--set task.min_push=20",
            "min_push must not exceed max_push",
        ),
    ] {
        place.refused(&format!("{TRAIN} {rest} --out run"), 2, &[part]);
    }
}
