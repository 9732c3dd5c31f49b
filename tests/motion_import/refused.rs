//! What is refused, and that no input panics.

use super::{SMALL, import, parse, refusal, walking};
use footwork::motion::bvh;
use footwork::motion::import::ImportOptions;
use footwork::motion::manifest;
use footwork::motion::resample::resample;
use proptest::prelude::*;
use std::path::Path;

#[test]
fn malformed_files_are_refused_with_the_line() {
    let second_root = SMALL.replace("MOTION", "ROOT Other\n{\nOFFSET 0 0 0\n}\nMOTION");
    let twice = SMALL.replace("JOINT Spine", "JOINT Hips");
    let cases = [
        ("", "line 1: the file is empty"),
        (" \r\n\t\n", "the file is empty"),
        (
            "PK\u{3}\u{4}\0\0",
            "begins with HIERARCHY, this one with 'PK\\u{3}",
        ),
        ("HIERARCHY\nMOTION\n", "line 2: MOTION before any ROOT"),
        (&second_root, "line 16: a second ROOT"),
        (&twice, "line 6: a second joint called 'Hips'"),
        (&SMALL[..64], "line 5: unknown channel 'Ypos'"),
        (&SMALL[..36], "truncated"),
        (
            &SMALL.replace("  }\n}\n", "  }\n"),
            "line 15: MOTION while 1 braces",
        ),
        (
            &SMALL.replace("MOTION", "}\nMOTION"),
            "line 16: '}' without a '{'",
        ),
        (
            &SMALL.replace("OFFSET 0 10 0", ""),
            "line 14: a block closes without an OFFSET",
        ),
        (
            &SMALL.replace("0 10 0", "0 ten 0"),
            "line 8: expected a number, found 'ten'",
        ),
        (
            &SMALL.replace("0 10 0", "0 NaN 0"),
            "line 8: 'NaN' is no usable number",
        ),
        (
            &SMALL.replace("Yrotation", "Yscale"),
            "line 5: unknown channel 'Yscale'",
        ),
        (
            &SMALL.replace("CHANNELS 4", "CHANNELS four"),
            "line 5: expected the number of channels",
        ),
        (
            &SMALL.replace("Zposition", "Yposition"),
            "line 5: one position channel twice",
        ),
        (
            &SMALL.replace("JOINT", "JOIN"),
            "line 6: unexpected 'JOIN'; here may stand OFFSET",
        ),
        (
            &SMALL.replace("Frames: 2", "Frames: 0"),
            "line 17: zero frames",
        ),
        (
            &SMALL.replace("Frames: 2", "Frames: -2"),
            "line 17: expected a number of frames",
        ),
        (
            &SMALL.replace("Frames: 2", "2"),
            "line 17: expected 'Frames:', found '2'",
        ),
        (
            &SMALL.replace("Frames: 2", "Frames: 18446744073709551615"),
            "line 20: expected 92233720368547758075 values",
        ),
        (
            &SMALL.replace("0.0333333", "0"),
            "line 18: a frame time of 0 s",
        ),
        (
            &SMALL.replace("0.0333333", "-0.03"),
            "line 18: a frame time of -0.03 s",
        ),
        (
            &SMALL.replace("0.0333333", "nan"),
            "line 18: 'nan' is no usable number",
        ),
        (
            &SMALL.replace("90 45", "90 inf"),
            "line 19: 'inf' is no usable number",
        ),
        (
            &SMALL.replace("90 45", "90 1e30"),
            "line 19: '1e30' is no usable number",
        ),
        (
            &SMALL.replace("90 45", "90 4,5"),
            "line 19: expected a number, found '4,5'",
        ),
        (
            &SMALL.replace(" 0 -45", " 0"),
            "line 20: expected 10 values (2 frames of 5), found 9 (1 whole frames and 4 values); the file is truncated",
        ),
        (
            &format!("{SMALL}7\n"),
            "line 21: expected 10 values (2 frames of 5), found 11",
        ),
        (
            SMALL.split("Frame Time").next().unwrap(),
            "ends before 'Frame Time:'",
        ),
        (
            SMALL.split("Frames").next().unwrap(),
            "line 16: the file ends before 'Frames:'",
        ),
    ];
    for (text, expected) in cases {
        let message = refusal(text);
        assert!(message.starts_with("test.bvh, line "), "{message}");
        assert!(message.contains(expected), "{expected} / {message}");
    }
}

/// The text of a chain of joints, its braces still open.
fn chain(joints: usize) -> String {
    let open = |joint| format!("JOINT j{joint}\n{{OFFSET 0 1 0\n");
    let rest: String = (1..joints).map(open).collect();
    format!("HIERARCHY ROOT j0 {{OFFSET 0 0 0 CHANNELS 1 Xrotation\n{rest}")
}

#[test]
fn deep_nesting_costs_no_stack() {
    let most = bvh::MAX_JOINTS;
    assert!(refusal(&chain(500_000)).contains("more than 4096 joints"));
    assert!(refusal(&chain(most)).contains("4096 braces still open"));
    let braces = "}".repeat(most);
    let motion = "MOTION\nFrames: 1\nFrame Time: 0.01\n5\n";
    let recording = parse(&format!("{}{braces}\n{motion}", chain(most)));
    assert_eq!(recording.skeleton.joints(), most);
    assert!(bvh::to_text(&recording.into_clip("deep", 0.01, 0..1)).is_ok());
    let ends = "End Site {".repeat(500_000);
    assert!(refusal(&format!("{}{ends}", chain(1))).contains("unexpected 'End'"));
}

#[test]
fn a_small_file_cannot_claim_a_large_memory() {
    let values = "0 ".repeat(10_000);
    let motion = format!("MOTION\nFrames: 10000\nFrame Time: 0.01\n{values}");
    let text = format!("{}{}\n{motion}", chain(4000), "}".repeat(4000));
    assert!(refusal(&text).contains("10000 frames of 4000 joints are too many"));
}

#[test]
fn files_that_are_no_text_or_too_large() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("binary.bvh");
    std::fs::write(&path, b"HIERARCHY\nROOT H\xff\xfe").unwrap();
    let message = bvh::read(&path).unwrap_err().to_string();
    assert!(
        message.contains("line 2: bytes that are not UTF-8"),
        "{message}"
    );

    // Sparse: it takes no room on the disk.
    let path = folder.path().join("giant.bvh");
    let file = std::fs::File::create(&path).unwrap();
    file.set_len(bvh::MAX_BYTES + 1).unwrap();
    let message = bvh::read(&path).unwrap_err().to_string();
    assert!(message.contains("more than 1073741824 bytes"), "{message}");

    let message = bvh::read(Path::new("absent.bvh")).unwrap_err().to_string();
    assert!(message.contains("cannot read absent.bvh"), "{message}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]
    #[test]
    fn no_damaged_person_panics(
        cuts in proptest::collection::vec((0_usize..9_000, 0_usize..12, "[ 0-9a-zA-Z{}.:\n-]{0,6}"), 1..4),
    ) {
        let mut text = bvh::to_text(&walking(70)).unwrap();
        for (start, length, patch) in cuts {
            let start = start.min(text.len());
            let end = (start + length).min(text.len());
            text.replace_range(start..end, &patch);
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("walk.bvh");
        std::fs::write(&path, text).unwrap();
        for trim in [false, true] {
            let options = ImportOptions { trim, ..ImportOptions::default() };
            if let Ok(import) = import(&path, &options) {
                let clip = &import.clips[0];
                prop_assert!(clip.positions.iter().all(|p| p.is_finite()));
                prop_assert!(clip.rotations.iter().all(|q| q.is_normalized()));
            }
        }
    }
}

proptest! {
    #[test]
    fn no_bytes_panic(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        let text = String::from_utf8_lossy(&bytes);
        let _ = bvh::parse(&text, Path::new("x"));
        let _ = bvh::parse(&format!("HIERARCHY ROOT {text}"), Path::new("x"));
        let _ = manifest::parse(&text, Path::new("x"));
    }

    #[test]
    fn no_damage_panics(
        cuts in proptest::collection::vec((0_usize..400, 0_usize..30, "[ 0-9a-zA-Z{}.:\n-]{0,6}"), 1..5),
    ) {
        let mut text = SMALL.to_string();
        for (start, length, patch) in cuts {
            let start = start.min(text.len());
            let end = (start + length).min(text.len());
            text.replace_range(start..end, &patch);
        }
        if let Ok(recording) = bvh::parse(&text, Path::new("x")) {
            let frames = recording.frames();
            prop_assert!(recording.rotations.iter().all(|q| q.is_normalized()));
            resample(recording.into_clip("x", 0.01, 0..frames));
        }
    }
}
