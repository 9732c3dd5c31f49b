//! `footwork export`.

use super::{Place, TRAIN, python};

/// Files of policies, and how they begin: an ONNX file with its version's field, a safetensors file with the
/// length of its header.
fn is_onnx(bytes: &[u8]) -> bool {
    bytes.starts_with(&[8, 7]) && bytes.len() > 1000
}

fn is_safetensors(bytes: &[u8]) -> bool {
    let length = u64::from_le_bytes(bytes[..8].try_into().unwrap()) as usize;
    serde_json::from_slice::<serde_json::Value>(&bytes[8..8 + length]).is_ok()
}

#[test]
fn policies_are_taken_away() {
    let place = Place::with_run();
    let out = place.done("export run --format onnx --out plane.onnx").out;
    assert_eq!(out, "plane.onnx\n");
    let plane = std::fs::read(place.path("plane.onnx")).unwrap();
    assert!(is_onnx(&plane));
    place.done("export run/checkpoints/last.ckpt --format onnx --out again.onnx");
    assert!(std::fs::read(place.path("again.onnx")).unwrap() == plane);
    place.done("export run --format safetensors --out plane.safetensors");
    assert!(is_safetensors(
        &std::fs::read(place.path("plane.safetensors")).unwrap()
    ));
    // Where the data has moved to is said as everywhere.
    std::fs::rename(place.path("small.footwork"), place.path("moved.footwork")).unwrap();
    let gone = "export run --format onnx --out gone.onnx";
    place.refused(gone, 1, &["--data", "is gone"]);
    place.done(&format!("{gone} --data moved.footwork"));
    assert!(std::fs::read(place.path("gone.onnx")).unwrap() == plane);
}

#[test]
fn a_policy_takes_its_low_level_with_it() {
    let place = Place::with_low_level(105);
    let small =
        "--device cpu --envs 16 --set ppo.rollout_length=4 --set ppo.minibatch_size=32 --steps 128";
    place.done(&format!("train punch --skills low {small} --out punch"));
    place.done("export punch --format onnx --out punch.onnx");
    let file = std::fs::read(place.path("punch.onnx")).unwrap();
    let has = |name: &[u8]| file.windows(name.len()).any(|part| part == name);
    assert!(
        is_onnx(&file) && has(b"high_level.layers.0.weight") && has(b"low_level.layers.0.weight")
    );
}

#[test]
fn what_cannot_be_exported_is_refused() {
    let place = Place::with_run();
    place.write("mine.onnx", "mine");
    place.write("text", "no run");
    std::fs::create_dir(place.path("folder")).unwrap();
    let formats = "possible values: onnx, safetensors, bvh, gltf, mjcf";
    for (words, code, parts) in [
        (
            "run --format fbx --out a",
            2,
            &["invalid value 'fbx'", formats] as &[&str],
        ),
        (
            "run --format onx --out a",
            2,
            &["a similar value exists: 'onnx'"],
        ),
        ("run --out a.onnx", 2, &["required arguments"]),
        ("run --format onnx", 2, &["required arguments"]),
        (
            "run --format onnx --out mine.onnx",
            1,
            &["mine.onnx exists", "--force"],
        ),
        ("run --format onnx --out folder", 1, &["folder is a folder"]),
        (
            "run --format onnx --out folder --force",
            1,
            &["folder is a folder"],
        ),
        (
            "run --format onnx --out gone/a.onnx",
            1,
            &["there is no folder gone"],
        ),
        (
            "run --format onnx --out /dev/null --force",
            1,
            &["cannot write /dev/null"],
        ),
        (
            "gone --format onnx --out a.onnx",
            1,
            &["gone is not a run folder"],
        ),
        (
            "text --format onnx --out a.onnx",
            1,
            &["text is not in the checkpoints of a run"],
        ),
        (
            "run --skills low --format onnx --out a",
            2,
            &["steers no low level"],
        ),
        (
            "run --format mjcf --out a.xml",
            2,
            &[
                "simulated bodies",
                "`plane`",
                "exported as onnx, safetensors, bvh, gltf",
            ],
        ),
    ] {
        place.refused(&format!("export {words}"), code, parts);
    }
    assert_eq!(place.read("mine.onnx"), "mine");
    place.done("export run --format onnx --out mine.onnx --force");
    assert!(is_onnx(&std::fs::read(place.path("mine.onnx")).unwrap()));
}

/// A program that knows nothing but the file's metadata, and the database.
#[test]
fn a_policy_is_run_from_its_metadata_alone() {
    let place = Place::with_data();
    place.done(&format!("{TRAIN} --steps 400000 --out run"));
    place.done("export run --format onnx --out plane.onnx");
    let [policy, database] = ["plane.onnx", "small.footwork"].map(|file| place.path(file));
    let files = [policy.as_os_str(), database.as_os_str()];
    let told = python::run("examples/drive_policy.py", &files);
    let words: Vec<&str> = told.split(' ').collect();
    assert_eq!(words[1..3], ["of", "200"], "{told}");
    assert!(words[0].parse::<u32>().unwrap() >= 190, "{told}");
}
