//! Databases and checkpoints that were cut, changed, or are something else.

use super::Place;
use footwork::motion::database::Database;
use footwork::train::checkpoint::Checkpoint;
use serde_json::{Value, json};
use std::path::Path;

/// Whether a file can be loaded.
type Loads = fn(&Path) -> bool;

const LAST: &str = "run/checkpoints/last.ckpt";

/// Header and arrays of a file.
fn open(bytes: &[u8]) -> (Value, Vec<u8>) {
    let length = u64::from_le_bytes(bytes[24..32].try_into().unwrap()) as usize;
    let (header, arrays) = bytes[32..].split_at(length);
    (serde_json::from_slice(header).unwrap(), arrays.to_vec())
}

/// A file of the same kind with another header and other arrays, and a checksum that fits.
fn seal(bytes: &[u8], header: &Value, arrays: &[u8]) -> Vec<u8> {
    let header = header.to_string().into_bytes();
    let mut rest = (header.len() as u64).to_le_bytes().to_vec();
    rest.extend(header);
    rest.extend(arrays);
    let checksum = crc32fast::hash(&rest).to_le_bytes();
    [&bytes[..20], &checksum, &rest].concat()
}

/// Changes the header of a file.
fn change(bytes: &[u8], at: &str, value: Value) -> Vec<u8> {
    let (mut header, arrays) = open(bytes);
    *header.pointer_mut(at).unwrap() = value;
    seal(bytes, &header, &arrays)
}

/// Puts a NaN where an array begins.
fn with_nan(bytes: &[u8], name: &str) -> Vec<u8> {
    let (header, mut arrays) = open(bytes);
    let listed = header["arrays"].as_array().unwrap().iter();
    let before = listed.take_while(|array| array[0] != name);
    let at = 4 * before.map(|array| array[1].as_u64().unwrap()).sum::<u64>() as usize;
    // Of either precision.
    arrays[at..][..8].fill(0xff);
    seal(bytes, &header, &arrays)
}

fn newer(bytes: &[u8]) -> Vec<u8> {
    [&bytes[..16], &9u32.to_le_bytes(), &bytes[20..]].concat()
}

/// Places all over a file, densest where it begins.
fn places(length: usize) -> impl Iterator<Item = usize> {
    let all_over = (1..100).map(move |part| length * part / 100);
    (0..64).chain(all_over).chain([length - 1])
}

#[test]
fn no_cut_and_no_changed_byte_goes_unnoticed() {
    let place = Place::with_run();
    let files: [(&str, Loads); 2] = [
        ("small.footwork", |path| Database::load(path).is_ok()),
        (LAST, |path| Checkpoint::load(path).is_ok()),
    ];
    for (name, loads) in files {
        let path = place.path(name);
        let bytes = std::fs::read(&path).unwrap();
        assert!(loads(&path));
        for at in places(bytes.len()) {
            place.write(name, &bytes[..at]);
            assert!(!loads(&path), "{name} cut at {at}");
            let mut changed = bytes.clone();
            changed[at] ^= 0x10;
            place.write(name, changed);
            assert!(!loads(&path), "{name} changed at {at}");
        }
    }
}

#[test]
fn databases_that_are_none_are_refused() {
    let place = Place::with_data();
    let good = std::fs::read(place.path("small.footwork")).unwrap();
    let (header, arrays) = open(&good);
    let longer = [&arrays[..], &[0; 8]].concat();
    let mut changed = good.clone();
    changed[1000] ^= 1;
    for (contents, part) in [
        (vec![], "nor a footwork database"),
        (b"a text".to_vec(), "nor a footwork database"),
        (good[..20].to_vec(), "ends within its first 32 bytes"),
        (good[..1000].to_vec(), "checksum"),
        (changed, "checksum"),
        (newer(&good), "use a newer footwork"),
        (seal(&good, &header, &longer), "longer than its contents"),
        (seal(&good, &header, &arrays[8..]), "`rotations` is cut off"),
        (with_nan(&good, "features"), "not finite"),
        (
            change(&good, "/header/frames", json!(1)),
            "do not fit together",
        ),
        (
            change(&good, "/header/roles/hips", json!(999)),
            "no tree of joints",
        ),
        (
            change(&good, "/header/skeleton/parents/0", json!(3)),
            "no tree of joints",
        ),
        (
            change(&good, "/header/clips/1/first", json!(1u64 << 63)),
            "do not fit together",
        ),
        (
            change(&good, "/header/skeleton/offsets/3/1", json!(1e300)),
            "numbers that no motion has",
        ),
        (
            change(&good, "/header/weights/foot_position", json!(-1.0)),
            "numbers that no motion has",
        ),
        (
            change(&good, "/header/normalisation/scale/2", json!(1e30)),
            "numbers that no motion has",
        ),
        (
            change(&good, "/header/clips", json!([])),
            "do not fit together",
        ),
        (change(&good, "/arrays/0/1", json!(u64::MAX)), "is cut off"),
        (
            change(&good, "/arrays", json!([])),
            "longer than its contents",
        ),
    ] {
        place.write("bad.footwork", contents);
        place.refused("data info bad.footwork", 1, &[part, "bad.footwork"]);
        let train = "train plane --device cpu --data bad.footwork --out run";
        place.refused(train, 1, &[part, "bad.footwork"]);
    }
}

#[test]
fn checkpoints_that_are_none_are_refused() {
    let place = Place::with_run();
    let good = std::fs::read(place.path(LAST)).unwrap();
    for (contents, part) in [
        (vec![], "is not a footwork checkpoint"),
        (
            std::fs::read(place.path("small.footwork")).unwrap(),
            "a footwork database, not a checkpoint",
        ),
        (good[..good.len() / 2].to_vec(), "is damaged (its checksum"),
        (newer(&good), "use a newer footwork"),
        (with_nan(&good, "policy/parameters"), "not finite"),
        (
            change(&good, "/header/run/run/task", json!("stairs")),
            "is of the task `stairs`, not of `plane`",
        ),
        (
            change(&good, "/header/run/run/spec/observation/vector", json!(40)),
            "with 40 observations and 12 actions, not with 17 observations",
        ),
        (
            change(&good, "/header/run/run/fingerprint", json!(7)),
            "fingerprint 00000007",
        ),
        (change(&good, "/header/run", json!({})), "it has no `run`"),
        (
            change(&good, "/header/policy/network/hidden", json!([16, 16])),
            "`parameters` has",
        ),
        (
            change(
                &good,
                "/header/policy/network/hidden",
                json!([1u64 << 40, 1u64 << 40]),
            ),
            "layer of width",
        ),
    ] {
        place.write(LAST, contents);
        place.refused("eval run", 1, &[part, "last.ckpt"]);
        place.refused(
            "train plane --resume run --steps 10240",
            1,
            &[part, "last.ckpt"],
        );
    }
    // What only a resumed training needs.
    for (name, part) in [
        ("learner/rates", "its rates are not finite"),
        ("envs.0/state_f32", "not finite"),
    ] {
        place.write(LAST, with_nan(&good, name));
        place.refused(
            "train plane --resume run --steps 10240",
            1,
            &[part, "last.ckpt"],
        );
    }
    std::fs::remove_file(place.path(LAST)).unwrap();
    place.refused(
        "eval run",
        1,
        &["last.ckpt is missing", "name one of the other checkpoints"],
    );
    place.refused("train plane --resume run", 1, &["last.ckpt is missing"]);
}

#[test]
fn a_run_whose_data_or_configuration_changed_is_not_resumed() {
    let place = Place::with_run();
    let resume = "train plane --resume run --steps 10240";
    let config = place.read("run/config.toml");
    for (was, is, key) in [
        ("envs = 64", "envs = 32", "`ppo.envs`"),
        (
            "hidden = [32, 32]",
            "hidden = [16, 16]",
            "`ppo.network.hidden`",
        ),
        (
            "target_extent = 5.0",
            "target_extent = 4.0",
            "`task.target_extent`",
        ),
        ("seed = 1", "seed = 2", "`seed`"),
    ] {
        assert!(config.contains(was));
        place.write("run/config.toml", config.replacen(was, is, 1));
        place.refused(resume, 1, &[key, "config.toml", "put it back"]);
    }
    // A version that knew fewer choices left its checkpoint and its configuration.
    let good = std::fs::read(place.path(LAST)).unwrap();
    let mut older = Checkpoint::load(&place.path(LAST)).unwrap();
    let known = older.header.config.lines();
    let known = known.filter(|line| !line.starts_with("value_clip"));
    older.header.config = known.collect::<Vec<_>>().join("\n");
    assert!(older.header.config.len() < config.len());
    older.save(&place.path(LAST)).unwrap();
    place.write("run/config.toml", &older.header.config);
    place.refused(resume, 1, &["`ppo.value_clip`", "version of footwork"]);
    place.write(LAST, good);
    place.write("run/config.toml", config.replacen("steps", "stepz", 1));
    place.refused(resume, 2, &["unknown key `stepz`", "run/config.toml"]);
    place.refused("eval run", 2, &["unknown key `stepz`"]);
    place.write("run/config.toml", &config);

    place.done("data synth --minutes 3 --seed 2 --out small.footwork");
    place.refused(resume, 1, &["was trained with other data", "last.ckpt"]);
    place.refused("eval run", 1, &["was trained with other data"]);
    std::fs::remove_file(place.path("small.footwork")).unwrap();
    place.refused(resume, 1, &["is gone: it was", "small.footwork", "--data"]);
}

/// A line of the metrics that is none costs that line.
#[test]
fn damaged_metrics_cost_no_more_than_their_line() {
    let place = Place::with_run();
    let good = place.read("run/metrics.jsonl");
    let lines: Vec<&str> = good.lines().collect();
    let whole = lines.len();
    for (line, bad) in [
        (2, lines[2].as_bytes()[..60].to_vec()),
        (3, vec![0; 80]),
        (4, b"\xff\xfe nonsense".to_vec()),
        (5, [lines[5], lines[6]].concat().into_bytes()),
    ] {
        let mut damaged: Vec<Vec<u8>> = lines.iter().map(|line| line.as_bytes().to_vec()).collect();
        damaged[line] = bad;
        place.write("run/metrics.jsonl", damaged.join(&b'\n'));
        let before = std::fs::read(place.path(LAST)).unwrap();
        let told = place.done("train plane --resume run --steps 10240");
        assert!(
            told.err
                .contains(&format!("metrics.jsonl, line {},", line + 1)),
            "{told:?}"
        );
        assert_eq!(crate::rows(&place.path("run")).len(), whole - 1 + 2);
        place.write("run/checkpoints/last.ckpt", before);
        place.write("run/metrics.jsonl", &good);
    }
}
