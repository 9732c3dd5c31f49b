//! Boxing: trainings by self-play, their evaluation, pictures and tournaments, and what they refuse.

use super::{Place, keys, rows};
use serde_json::Value;

/// Bouts of half a second, against one who stands and soon the last two policies.
const SMALL: &str = "--device cpu --envs 8 --set ppo.rollout_length=4 --set ppo.minibatch_size=16 \
                     --set task.episode_s=0.5 --set self_play.updates=2 --set self_play.pool=2 \
                     --set ppo.network.hidden=[16,16]";
const STYLE: &str = "--set amp.hidden=[16,16] --set amp.minibatch_size=16 --set amp.replay_capacity=64 \
                     --set amp.replay_per_update=16 --set amp.steps=2";

const METRICS: [&str; 7] = [
    "win_rate",
    "pool_size",
    "pool_joined",
    "engagement",
    "knockdowns",
    "damage",
    "style_reward",
];

#[test]
fn fighters_learn_by_themselves_and_are_evaluated() {
    let place = Place::with_low_level(105);
    place.done(&format!(
        "train box {SMALL} {STYLE} --steps 192 --out alone"
    ));
    let told = place.done(&format!(
        "train box --skills low {SMALL} --steps 96 --out steered"
    ));
    assert!(told.out.contains("whom nobody has trained"), "{told:?}");
    let config = place.read("alone/config.toml");
    assert!(config.contains("[self_play]"), "{config}");
    for run in ["alone", "steered"] {
        let rows = rows(&place.path(run));
        // At the last at the latest, a bout of half a second has ended.
        for key in METRICS {
            assert!(
                keys(rows.last().unwrap()).contains(&key),
                "no {key} in {run}"
            );
        }
        // At first there are one who stands and the untrained policy; every other update another joins.
        for (update, row) in rows.iter().enumerate() {
            let joined = (2 + update / 2) as f64;
            assert_eq!(row["pool_joined"], joined, "{row}");
            assert_eq!(row["pool_size"], joined.min(3.0), "{row}");
        }
        let found = place.done(&format!("eval {run} --episodes 4 --json")).out;
        let found: Value = serde_json::from_str(&found).unwrap();
        for key in [
            "bouts",
            "won",
            "engagement",
            "knockdowns",
            "from_behind",
            "style",
        ] {
            assert!(keys(&found).contains(&key), "no {key} in {found}");
        }
        place.done(&format!("render {run} --seconds 1 --out {run}.png"));
    }
    place.done("render steered --seconds 0.2 --size 64x64 --out steered.gif");
}

#[test]
fn a_pool_goes_on_where_it_was() {
    let place = Place::with_low_level(105);
    for (kind, more) in [("alone", STYLE), ("steered", "--skills low")] {
        let begun = format!("train box {SMALL} {more} --set self_play.pool=1");
        let [whole, halves] = ["whole", "halves"].map(|run| format!("{kind}-{run}"));
        place.done(&format!("{begun} --steps 256 --out {whole}"));
        place.done(&format!("{begun} --steps 128 --out {halves}"));
        place.done(&format!("train box --resume {halves} --steps 256"));
        assert!(place.sections(&whole) == place.sections(&halves), "{kind}");
    }
    // What decides over the opponents stays.
    let config = place.read("alone-whole/config.toml");
    place.write(
        "alone-whole/config.toml",
        config.replace("win_rate = 0.8", "win_rate = 0.7"),
    );
    place.refused(
        "train box --resume alone-whole --steps 512",
        1,
        &["self_play.win_rate"],
    );
}

#[test]
fn checkpoints_meet_in_tournaments() {
    let place = Place::with_low_level(105);
    place.done(&format!(
        "train box --skills low {SMALL} --set checkpoint_every=64 --steps 128 --out run"
    ));
    let told = place.done("tournament --checkpoints run --bouts 4 --plot wins.png");
    assert!(
        told.out.contains("run/steps-0000000064") && told.out.contains("(does nothing)"),
        "{told:?}"
    );
    assert!(place.path("wins.png").exists());
    let found = place
        .done("tournament run run/checkpoints/steps-0000000064.ckpt --bouts 2 --json")
        .out;
    let found: Value = serde_json::from_str(&found).unwrap();
    assert_eq!(found["bouts"], 2);
    let players = found["players"].as_array().unwrap();
    let elo: f64 = players
        .iter()
        .map(|player| player["elo"].as_f64().unwrap())
        .sum();
    assert!(players.len() == 3 && (elo - 1200.0).abs() < 1e-6, "{found}");
    for player in players {
        assert_eq!(keys(player), ["elo", "high", "low", "name"], "{found}");
    }
    let wins = found["wins"].as_array().unwrap();
    for one in 0..3 {
        for other in 0..3 {
            let won = |one: usize, other: usize| wins[one][other].as_u64().unwrap();
            assert!(
                won(one, other) + won(other, one) <= 2 * u64::from(one != other),
                "{found}"
            );
        }
    }
    place.done(
        "train stand --device cpu --envs 4 --set ppo.rollout_length=4 --steps 16 --out stand",
    );
    // Who fights, and moved by whom.
    place.done(&format!("train box {SMALL} {STYLE} --steps 32 --out alone"));
    for (words, part) in [
        (
            "play stand --fighter run",
            "stand is a run of `stand`, in which nobody fights",
        ),
        (
            "play run --fighter stand",
            "stand is a run of `stand`, which has learned to go to nobody",
        ),
        (
            "play run --fighter alone",
            "alone moves by another low level than run",
        ),
    ] {
        place.refused(words, 2, &[part, "--fighter"]);
    }
    for (words, part) in [
        ("tournament run", "two checkpoints at least"),
        (
            "tournament run run --bouts 3",
            "--bouts must be an even number",
        ),
        (
            "tournament run stand",
            "a run of `stand`, in which nobody fights",
        ),
    ] {
        place.refused(words, 2, &[part]);
    }
    place.refused(
        "tournament run nowhere",
        1,
        &["nowhere is not a run folder"],
    );
}

#[test]
fn what_cannot_be_fought_is_refused() {
    let place = Place::new();
    for (words, part) in [
        (
            "train box --set task.arena=0.5 --out run",
            "an arena of 0.5 m to each side is too small",
        ),
        (
            "train box --set self_play.pool=0 --out run",
            "self_play.pool is 0",
        ),
        (
            "train box --set self_play.scripted=1.5 --out run",
            "self_play.scripted is 1.5",
        ),
        (
            "train box --set self_play.win_rate=2.0 --out run",
            "self_play.win_rate is 2",
        ),
        (
            "train box --set self_play.decay=2.0 --out run",
            "self_play.decay is 2",
        ),
        (
            "train punch --set self_play.pool=2 --out run",
            "unknown key `self_play`",
        ),
        (
            "train box --set self_play.pol=2 --out run",
            "did you mean `self_play.pool`",
        ),
    ] {
        place.refused(words, 2, &[part]);
    }
}
