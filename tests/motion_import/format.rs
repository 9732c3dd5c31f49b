//! The format, read and written.

use super::{PERSON, SMALL, assert_same_motion, moving, parse, v};
use footwork::motion::bvh;
use glam::{EulerRot, Quat, Vec3};
use std::path::Path;

#[test]
fn reads_a_small_file() {
    let recording = parse(SMALL);
    assert_eq!(recording.skeleton.names, ["Hips", "Spine"]);
    assert_eq!(recording.skeleton.parents, [None, Some(0)]);
    assert_eq!(recording.skeleton.ends, [(1, v(0.0, 5.0, 0.0))]);
    assert_eq!(recording.positions, [v(1.0, 2.0, 3.0), v(4.0, 5.0, 6.0)]);
    assert!((recording.rate - 30.0).abs() < 0.01);
    // Turned left by 90 degrees and bent forward, the spine's tip points up and along +x.
    let (at, turned) = recording.skeleton.world(Vec3::ZERO, recording.pose(0));
    let tip = at[1] + turned[1] * v(0.0, 5.0, 0.0);
    let half = 5.0 * 0.5_f32.sqrt();
    assert!(tip.distance(v(half, 10.0 + half, 0.0)) < 1e-4, "{tip}");
}

#[test]
fn line_ends_tabs_wrapping_and_braces_do_not_matter() {
    let plain = parse(SMALL);
    assert_eq!(plain, parse(&SMALL.replace('\n', "\r\n")));
    assert_eq!(plain, parse(&SMALL.replace("  ", "\t")));
    assert_eq!(plain, parse(&SMALL.replace("Frames: 2", "Frames:\t2")));
    assert_eq!(
        plain,
        parse(&SMALL.replace("1 2 3 90 45\n4", "1 2\n3 90 45 4\n"))
    );
    assert_eq!(plain, parse(&SMALL.replace("\n  {", "{")));
    assert_eq!(plain, parse(&format!("\u{feff}{SMALL}")));
}

#[test]
fn rotations_apply_in_the_order_of_the_channels() {
    for (order, euler) in [
        ("Zrotation Yrotation Xrotation", EulerRot::ZYX),
        ("Zrotation Xrotation Yrotation", EulerRot::ZXY),
        ("Xrotation Yrotation Zrotation", EulerRot::XYZ),
        ("Yrotation Xrotation Zrotation", EulerRot::YXZ),
    ] {
        let channels = format!("CHANNELS 6 Zposition {order} Xposition Yposition");
        let text = SMALL
            .replace(
                "CHANNELS 4 Xposition Yposition Zposition Yrotation",
                &channels,
            )
            .replace("1 2 3 90 45", "3 10 20 30 1 2 45")
            .replace("4 5 6 0 -45", "6 0 0 0 4 5 -45");
        let recording = parse(&text);
        let [a, b, c] = [10.0_f32, 20.0, 30.0].map(f32::to_radians);
        let expected = Quat::from_euler(euler, a, b, c);
        assert!(
            recording.pose(0)[0].angle_between(expected) < 1e-3,
            "{order}"
        );
        assert_eq!(recording.positions[0], v(1.0, 2.0, 3.0));
    }
}

#[test]
fn joints_without_channels_and_names_with_spaces() {
    let text = SMALL
        .replace("    CHANNELS 1 Xrotation\n", "")
        .replace("JOINT Spine", "JOINT Upper  Spine")
        .replace(" 45\n", "\n")
        .replace(" -45\n", "\n");
    let recording = parse(&text);
    assert_eq!(recording.skeleton.names[1], "Upper Spine");
    assert_eq!(recording.pose(1)[1], Quat::IDENTITY);
}

#[test]
fn bones_given_by_position_channels() {
    let spine = "CHANNELS 4 Xposition Yposition Zposition Xrotation";
    let still = SMALL
        .replace("CHANNELS 1 Xrotation", spine)
        .replace("90 45", "90 0 11 0 45")
        .replace("0 -45", "0 0 11.1 0 -45");
    let offset = parse(&still).skeleton.offsets[1];
    assert!(offset.distance(v(0.0, 11.05, 0.0)) < 1e-4, "{offset}");

    // Where a joint moves is kept, for the import to decide what it means.
    let slide = &parse(&still).slides[0];
    assert_eq!(slide.joint, 1);
    assert_eq!(slide.positions, [v(0.0, 11.0, 0.0), v(0.0, 11.1, 0.0)]);
    let rigid = still.replace("11.1", "11");
    assert!(parse(&rigid).slides.is_empty());

    // Zeros throughout say nothing: a body whose joints are all in one place is none.
    let silent = rigid.replace("0 11 0", "0 0 0");
    assert_eq!(parse(&silent).skeleton.offsets[1], v(0.0, 10.0, 0.0));
    let spoken = silent.replacen("90 0 0 0", "90 0 0 1", 1);
    assert!(parse(&spoken).skeleton.offsets[1].y.abs() < 1e-6);
}

#[test]
fn what_is_written_reads_back() {
    let mut clip = moving(&PERSON, 80);
    // The worst case for Euler angles: the middle one upright.
    clip.rotations[5] = Quat::from_rotation_y(90_f32.to_radians());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("written.bvh");
    bvh::write(&path, &clip).unwrap();
    let recording = bvh::read(&path).unwrap();
    let frames = recording.frames();
    let back = recording.into_clip("moving", 0.01, 0..frames);
    assert_same_motion(&clip, &back);
    assert_eq!(back.skeleton.ends.len(), 4);
    let files = std::fs::read_dir(folder.path()).unwrap().count();
    assert_eq!(files, 1, "no temporary file stays behind");
}

#[test]
fn nothing_half_is_written() {
    let clip = moving(&PERSON, 3);
    let path = Path::new("no-such-folder/x.bvh");
    let message = bvh::write(path, &clip).unwrap_err().to_string();
    assert!(message.contains("cannot write no-such-folder"), "{message}");
    let mut broken = clip.clone();
    broken.positions[1].x = f32::NAN;
    let message = bvh::to_text(&broken).unwrap_err().to_string();
    assert!(message.contains("not finite"), "{message}");
    let mut broken = clip;
    broken.skeleton.names[1] = "a}".to_string();
    assert!(bvh::to_text(&broken).is_err());
}
