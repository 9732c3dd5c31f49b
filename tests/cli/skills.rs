//! What is shown of a run of the task `skills`.

use super::Place;
use super::render::png;

/// A short training, of short episodes; what is missing is the folder.
const PPO: &str = "--device cpu --envs 16 --steps 128 --set ppo.rollout_length=8 --set ppo.minibatch_size=64 \
                   --set task.episode_s=1.0";
const AMP: &str = "--set amp.minibatch_size=32 --set amp.replay_capacity=256 \
                   --set amp.replay_per_update=64 --set amp.steps=2";

#[test]
fn latents_are_drawn_one_under_another_and_gone_between() {
    let place = Place::new();
    place.done(&format!(
        "train skills {PPO} {AMP} --set ase.low_level=ase --out run"
    ));
    let shown = |options: &str, file: &str| {
        let options = format!("{options} --start 0 --seconds 1 --out {file}");
        place.done(&format!("render run {options}"));
        png(&place, file)
    };
    let (_, one, _) = shown("--latents 1", "one.png");
    let (width, three, pixels) = shown("--latents 3", "three.png");
    assert!(three > 2 * one && width > 7 * 150, "{width} {three} {one}");
    assert!(shown("--latents 3", "again.png").2 == pixels);
    let (_, _, way) = shown("--interpolate 1,3", "way.png");
    assert!(way != shown("--interpolate 3,1", "back.png").2);
    assert!(way != shown("", "plain.png").2);
    place.done("render run --interpolate 1,2 --seconds 0.5 --rate 10 --size 96x64 --out way.gif");
}

#[test]
fn latents_that_there_are_not_are_refused() {
    let place = Place::new();
    place.done("data synth --minutes 0.5 --out synth.footwork --bvh few");
    let clips = "--data few --set ase.low_level=per-clip --out clips";
    place.done(&format!("train skills {PPO} {AMP} {clips}"));
    place.done(&format!("train stand {PPO} --out stand"));
    place.done("render clips --latents 1 --start 0 --seconds 1 --out clips.png");
    for (rest, part) in [
        ("clips --latents 0", "--latents must be from 1 to 16"),
        ("clips --latents 17", "--latents must be from 1 to 16"),
        ("clips --latents 16", "the number of the run's clips"),
        ("clips --latents -1", "invalid value '-1'"),
        ("clips --latents few", "invalid value 'few'"),
        ("clips --interpolate 1", "like 1,3"),
        ("clips --interpolate -1,2", "like 1,3"),
        ("clips --interpolate 0,2", "takes the numbers"),
        ("clips --interpolate 1,999", "takes the numbers"),
        ("clips --interpolate 2,2", "give two numbers"),
        ("clips --interpolate 1,2 --latents 3", "cannot be used with"),
        ("stand --latents 2", "`stand` has no latents"),
        ("stand --interpolate 1,2", "`stand` has no latents"),
    ] {
        place.refused(&format!("render {rest} --out one.png"), 2, &[part]);
    }
    let gif = "render clips --latents 2 --out one.gif";
    place.refused(gif, 2, &["must end in .png"]);
}
