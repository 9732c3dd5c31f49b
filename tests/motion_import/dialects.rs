//! What programs write that can only mean one thing, and the reason given for the rest.

use super::{SMALL, parse, refusal};
use footwork::motion::bvh;
use std::path::Path;

#[test]
fn other_ways_to_write_the_same() {
    let plain = parse(SMALL);
    for (name, text) in [
        ("CR line ends", SMALL.replace('\n', "\r")),
        ("CR LF line ends", SMALL.replace('\n', "\r\n")),
        (
            "one line",
            SMALL.replace("MOTION\nFrames: 2\n", "MOTION Frames: 2 "),
        ),
        (
            "no colons",
            SMALL.replace("Frames:", "Frames").replace("Time:", "Time"),
        ),
        ("blanks before colons", SMALL.replace("Time:", "Time :")),
        ("FrameTime", SMALL.replace("Frame Time", "FrameTime")),
        ("EndSite", SMALL.replace("End Site", "EndSite")),
        ("End_Site", SMALL.replace("End Site", "End_Site")),
        ("named end", SMALL.replace("End Site", "End Site \"Tip\"")),
        (
            "end with channels",
            SMALL.replace("OFFSET 0 5 0", "OFFSET 0 5 0\nCHANNELS 0"),
        ),
        (
            "comments",
            format!("# one\n// two\n{}", SMALL.replace("90 45", "90 45 # three")),
        ),
        (
            "comments inside",
            SMALL
                .replace("  {\n", "  { # a joint\n")
                .replace("Frames", "// all\nFrames"),
        ),
        ("Ctrl-Z", format!("{SMALL}\u{1a}")),
        ("NUL", format!("{SMALL}\0\0\0\n")),
        (
            "floating count",
            SMALL.replace("Frames: 2", "Frames: 2.000"),
        ),
        ("quoted names", SMALL.replace("Spine", "\"Spine\"")),
        (
            "lower case",
            SMALL
                .to_lowercase()
                .replace("hips", "Hips")
                .replace("spine", "Spine"),
        ),
        ("byte order mark", format!("\u{feff}{SMALL}")),
    ] {
        assert_eq!(parse(&text), plain, "{name}");
    }
}

#[test]
fn sixteen_bits_a_character() {
    let plain = parse(SMALL);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("wide.bvh");
    let big: fn(u16) -> [u8; 2] = u16::to_be_bytes;
    for order in [u16::to_le_bytes, big] {
        for mark in ["", "\u{feff}"] {
            let text = format!("{mark}{SMALL}");
            let bytes: Vec<u8> = text.encode_utf16().flat_map(order).collect();
            std::fs::write(&path, bytes).unwrap();
            assert_eq!(bvh::read(&path).unwrap(), plain);
        }
    }
    // Half of a pair that stands for one character.
    let mut bytes: Vec<u8> = SMALL.encode_utf16().flat_map(u16::to_le_bytes).collect();
    bytes.splice(40..42, [0x00, 0xd8]);
    std::fs::write(&path, bytes).unwrap();
    let message = bvh::read(&path).unwrap_err().to_string();
    assert!(message.contains("line 3: broken UTF-16"), "{message}");
}

#[test]
fn the_true_reason_for_what_is_refused() {
    let pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 1234\n";
    for (text, expected) in [
        (
            &*SMALL.replace("90 45", "-1.#IND00 45"),
            "line 19: '-1.#IND00' is no usable number",
        ),
        (
            &SMALL.replace("90 45", "-nan(ind) 45"),
            "line 19: '-nan(ind)' is no usable number",
        ),
        (
            &SMALL.replace("90 45", "90-45"),
            "found '90-45'; are these two numbers without a space",
        ),
        (
            &SMALL.replace("90 45", "90,5 45"),
            "found '90,5'; write decimal points",
        ),
        (
            &SMALL.replace(" 0 -45", " 0 -"),
            "line 20: the file ends with '-', which is no number; it is truncated",
        ),
        (
            &SMALL.replace("Frames: 2", "Frames: 2.5"),
            "line 17: expected a number of frames, found '2.5'",
        ),
        (
            &SMALL.replace("OFFSET 0 5 0", "OFFSET 0 5 0\nCHANNELS 1 Xrotation"),
            "line 13: an End Site with channels",
        ),
        (pointer, "line 1: this is Git LFS's pointer"),
        (
            &SMALL.replace('\n', "\r").replace("0 10 0", "0 ten 0"),
            "line 8: expected a number, found 'ten'",
        ),
    ] {
        let message = refusal(text);
        assert!(message.contains(expected), "{expected} / {message}");
    }
    let many = format!("{}{SMALL}", "# nothing\n".repeat(200_000));
    assert!(bvh::parse(&many, Path::new("x")).is_ok());
    let many = SMALL.replace(
        "Frames:",
        &format!("{}Frames:", "# nothing\n".repeat(200_000)),
    );
    assert!(bvh::parse(&many, Path::new("x")).is_ok());
}
