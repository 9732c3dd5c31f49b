//! `--device auto` and `--envs auto`: what is measured, kept and written down.

use super::{Place, TRAIN, Told};
use serde_json::Value;
use toml::Table;

/// A short training whose speeds are kept in a folder of this name.
fn train(place: &Place, cache: &str, rest: &str) -> Told {
    let words = format!(
        "train plane --data small.footwork --steps 256 --set ppo.network.hidden=[8] {rest}"
    );
    let mut command = place.command(&words);
    command.env("XDG_CACHE_HOME", place.path(cache));
    let told = Told::from(&words, command.output().unwrap());
    assert_eq!(told.code, Some(0), "{told:?}");
    told
}

const KEPT: &str = "cache/footwork/calibration.json";

/// The table `[ppo]` of a run.
fn ppo(place: &Place, run: &str) -> Table {
    let config: Table = place.read(&format!("{run}/config.toml")).parse().unwrap();
    config["ppo"].as_table().unwrap().clone()
}

fn numbers(kept: &Value) -> Vec<i64> {
    let rows = kept.as_array().unwrap().iter();
    rows.map(|row| row["envs"].as_i64().unwrap()).collect()
}

#[test]
fn auto_measures_once_and_is_resolved() {
    let place = Place::with_data();
    let first = train(&place, "cache", "--device cpu --envs auto --out first");
    assert!(first.err.contains("256 environments on cpu"), "{first:?}");
    assert!(!first.err.contains("measured before"), "{first:?}");
    let measured = numbers(&place.json(KEPT));
    assert!(measured.len() >= 3 && measured.starts_with(&[256, 512, 1024]));
    let chosen = ppo(&place, "first");
    assert!(measured.contains(&chosen["envs"].as_integer().unwrap()));
    let config = place.read("first/config.toml");
    assert!(config.contains("device = \"cpu\""), "{config}");
    let said = format!("chosen: {} environments on `cpu`", chosen["envs"]);
    assert!(first.err.contains(&said), "{first:?}");

    let again = train(&place, "cache", "--device cpu --envs auto --out again");
    let known = again.err.matches("as measured before").count();
    assert_eq!(known, measured.len(), "{again:?}");
    assert_eq!(place.read("again/config.toml"), config);
    place.done("train plane --resume again --steps 100000");

    // Another network is another matter.
    let wider = "--device cpu --envs auto --set ppo.network.hidden=[9] --out wider";
    let wider = train(&place, "cache", wider);
    assert!(!wider.err.contains("measured before"), "{wider:?}");
}

#[test]
fn speeds_that_cannot_be_read_or_kept_are_measured_anew() {
    let place = Place::with_data();
    std::fs::create_dir_all(place.path("cache/footwork")).unwrap();
    for (run, damaged) in ["{", "[{\"envs\": 256}]"].iter().enumerate() {
        place.write(KEPT, damaged);
        let words = format!("--device cpu --envs auto --out run-{run}");
        let told = train(&place, "cache", &words);
        assert!(told.err.contains("calibration.json is damaged"), "{told:?}");
        assert!(numbers(&place.json(KEPT)).len() >= 3);
    }
    let told = train(
        &place,
        "small.footwork",
        "--device cpu --envs auto --out run",
    );
    assert!(told.err.contains("note: cannot "), "{told:?}");
    assert!(told.err.contains("measures again"), "{told:?}");
}

#[test]
fn nothing_is_measured_where_there_is_no_choice() {
    let place = Place::with_data();
    train(&place, "cache", "--device cpu --out run");
    assert!(!place.path("cache").exists());
    assert_eq!(ppo(&place, "run")["envs"].as_integer(), Some(256));
}

#[test]
fn the_preset_follows_the_number_of_environments_and_keys_stay() {
    let place = Place::with_data();
    let keys = |words: &str, run: &str| {
        let told = train(
            &place,
            "cache",
            &format!("--device cpu {words} --out {run}"),
        );
        let ppo = ppo(&place, run);
        let names = ["envs", "rollout_length", "minibatch_size"];
        let keys = names.map(|name| ppo[name].as_integer().unwrap());
        (keys, ppo["learning_rate"].as_float().unwrap(), told)
    };
    let (more, rate, told) = keys("--envs 4096", "more");
    assert_eq!(more, [4096, 4, 2048]);
    assert!((rate - 4e-3).abs() < 1e-9);
    assert!(told.err.contains("take rollouts of 4 steps"), "{told:?}");
    let (fewer, rate, _) = keys("--envs 64", "fewer");
    assert_eq!((fewer, rate), ([64, 16, 512], 2e-3));
    let named = "--envs 4096 --set ppo.minibatch_size=512 --set ppo.learning_rate=0.002";
    let (named, rate, _) = keys(named, "named");
    assert_eq!((named, rate), ([4096, 4, 512], 2e-3));
    place.write("file.toml", "[ppo]\nrollout_length = 16");
    let (in_file, _, _) = keys("--envs 4096 --config file.toml", "in_file");
    assert_eq!(in_file, [4096, 16, 2048]);
    let (key, rate, _) = keys("--set ppo.envs=1024", "key");
    assert_eq!((key, rate), ([1024, 16, 512], 2e-3));
}

#[test]
fn calibration_is_on_request_too() {
    let place = Place::with_data();
    let words = "bench --calibrate plane --device cpu --data small.footwork";
    let mut command = place.command(words);
    command.env("XDG_CACHE_HOME", place.path("cache"));
    let told = Told::from(words, command.output().unwrap());
    assert_eq!(told.code, Some(0), "{told:?}");
    assert_eq!(told.out.matches("yes").count(), 1, "{told:?}");
    let measured = numbers(&place.json(KEPT));
    let rows = told.out.lines().filter(|line| line.starts_with("plane  "));
    assert_eq!(rows.count(), measured.len(), "{told:?}");
}

#[test]
fn what_is_no_number_of_environments_is_refused() {
    let place = Place::with_data();
    let refused = |words: &str, part: &str| {
        place.refused(&TRAIN.replace("64", words), 2, &[part]);
    };
    refused("foo", "give a number or `auto`");
    refused("0", "ppo.envs is 0");
    refused("auto --set ppo.envs=0", "ppo.envs is 0");
    place.refused(
        "bench --calibrate plan",
        2,
        &["similar value exists: 'plane'"],
    );
    place.refused(
        "bench --calibrate --filter search",
        2,
        &["cannot be used with"],
    );
}
