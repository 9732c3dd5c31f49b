//! What is shown of a run of the task `skills`.

use super::Place;
use super::render::png;

/// A short training; what is missing are the folder and how latents come to mean movements.
const TRAIN: &str = "train skills --device cpu --envs 16 --steps 128 --set ppo.rollout_length=8 \
                     --set ppo.minibatch_size=64 --set amp.minibatch_size=32 --set amp.replay_capacity=256 \
                     --set amp.replay_per_update=64 --set amp.steps=2";

#[test]
fn latents_are_drawn_one_under_another_and_gone_between() {
    let place = Place::new();
    place.done(&format!("{TRAIN} --out ase"));
    place.done(&format!("{TRAIN} --set ase.low_level=per-clip --out clips"));
    for run in ["ase", "clips"] {
        place.done(&format!(
            "render {run} --latents 3 --seconds 1 --out {run}.png"
        ));
        let (width, three, rgb) = png(&place, &format!("{run}.png"));
        place.done(&format!(
            "render {run} --latents 1 --seconds 1 --out {run}-one.png"
        ));
        let (_, one, first) = png(&place, &format!("{run}-one.png"));
        assert!(three > 2 * one && width > 7 * 150, "{width} {three} {one}");
        // The first strip is the first of both; only the space for words may differ.
        assert!(first.len() < rgb.len());
        place.done(&format!(
            "render {run} --interpolate 1,3 --seconds 1 --out {run}-way.png"
        ));
    }
    place.done("render ase --interpolate 1,2 --seconds 0.5 --rate 10 --size 96x64 --out way.gif");
    place.done("render ase --seconds 1 --out plain.png");
    assert!(png(&place, "plain.png").2 != png(&place, "ase-way.png").2);
}

#[test]
fn latents_that_there_are_not_are_refused() {
    let place = Place::new();
    place.done(&format!("{TRAIN} --set ase.low_level=per-clip --out clips"));
    place.done("train stand --device cpu --envs 16 --steps 128 --set ppo.rollout_length=8 --set ppo.minibatch_size=64 --out stand");
    for (rest, part) in [
        ("clips --latents 0", "--latents must be from 1 to 16"),
        ("clips --latents 17", "--latents must be from 1 to 16"),
        ("clips --latents -1", "invalid value '-1'"),
        ("clips --latents few", "invalid value 'few'"),
        ("clips --interpolate 1", "like 1,3"),
        ("clips --interpolate -1,2", "like 1,3"),
        ("clips --interpolate 0,2", "--interpolate takes the numbers"),
        (
            "clips --interpolate 1,999",
            "--interpolate takes the numbers",
        ),
        ("clips --interpolate 2,2", "give two numbers"),
        ("clips --interpolate 1,2 --latents 3", "cannot be used with"),
        ("stand --latents 2", "`stand` has no latents"),
        ("stand --interpolate 1,2", "`stand` has no latents"),
    ] {
        place.refused(&format!("render {rest} --out one.png"), 2, &[part]);
    }
    place.refused(
        "render clips --latents 2 --out one.gif",
        2,
        &["must end in .png"],
    );
}
