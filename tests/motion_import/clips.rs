//! What is done with clips, up to the import of a folder.

use super::{PERSON, moving, parse, person, skeleton, v};
use footwork::motion::bvh::Recording;
use footwork::motion::import::{ImportOptions, ImportedMotion, import};
use footwork::motion::mirror::{mirror, pairs};
use footwork::motion::resample::resample;
use footwork::motion::roles::Roles;
use footwork::motion::{manifest, tpose, units};
use glam::{Quat, Vec3};
use std::path::Path;

#[test]
fn resampling_thins_out_or_fills_in() {
    let mut clip = moving(&PERSON, 121);
    clip.rate = 119.9;
    let thin = resample(clip.clone());
    assert_eq!((thin.frames(), thin.rate), (31, 30.0));
    assert_eq!(thin.pose(2), clip.pose(8));
    assert_eq!(thin.positions[30], clip.positions[120]);

    for (rate, frames) in [(25.0, 145), (100.0, 37), (15.0, 241)] {
        clip.rate = rate;
        let even = resample(clip.clone());
        assert_eq!((even.frames(), even.rate), (frames, 30.0), "from {rate} Hz");
        // Linear in time: frame 6 is at 0.2 s, wherever that lies in the original.
        assert!((even.positions[6].x - 0.02 * 0.2 * rate).abs() < 1e-5);
        assert!(even.rotations.iter().all(|q| q.is_normalized()));
    }
    clip.rate = 15.0;
    let even = resample(clip.clone());
    assert!(even.pose(8)[3].angle_between(clip.pose(4)[3]) < 1e-3);
}

#[test]
fn mirroring_twice_gives_the_clip_back() {
    let mut joints = PERSON;
    // A lopsided subject.
    joints[2].2 = v(0.0, -0.44, 0.01);
    let clip = moving(&joints, 20);
    let once = mirror(&clip).unwrap();
    assert_ne!(once.skeleton.offsets[2], clip.skeleton.offsets[2]);
    assert_eq!(mirror(&once).unwrap(), clip);
    let pairs = pairs(&clip.skeleton).unwrap();
    for frame in 0..20 {
        let ((p, _), (q, _)) = (clip.world(frame), once.world(frame));
        for joint in 0..pairs.len() {
            let seen = p[pairs[joint]] * v(-1.0, 1.0, 1.0);
            assert!(q[joint].distance(seen) < 1e-5, "{frame} {joint}");
        }
    }
}

#[test]
fn mirroring_needs_both_sides() {
    let mut joints = PERSON;
    joints[10].0 = "LeftPaw";
    let message = mirror(&moving(&joints, 2)).unwrap_err().to_string();
    assert!(
        message.contains("'LeftPaw' has no counterpart 'RightPaw'"),
        "{message}"
    );
    joints = PERSON;
    joints[13].1 = 11;
    let message = mirror(&moving(&joints, 2)).unwrap_err().to_string();
    assert!(
        message.contains("do not hang on the tree alike"),
        "{message}"
    );
    joints = PERSON;
    joints[5].2 = v(0.0, 0.42, 0.0);
    joints[6].2 = v(0.4, 0.0, 0.0);
    let message = mirror(&moving(&joints, 2)).unwrap_err().to_string();
    assert!(message.contains("no axis of the joints"), "{message}");
}

#[test]
fn units_follow_from_the_legs() {
    let metres = skeleton(&PERSON);
    let roles = Roles::find(&metres).unwrap();
    for unit in units::COMMON {
        let mut scaled = metres.clone();
        scaled.offsets.iter_mut().for_each(|o| *o /= unit);
        assert_eq!(units::find(&scaled, &roles).unwrap(), unit);
    }
    let mut odd = metres.clone();
    odd.offsets.iter_mut().for_each(|o| *o *= 5.0);
    let unit = units::find(&odd, &roles).unwrap();
    assert!((unit * units::leg(&odd, &roles) - 0.85).abs() < 1e-4);
    odd.offsets.iter_mut().for_each(|o| *o = Vec3::ZERO);
    assert!(units::find(&odd, &roles).is_err());
}

/// 100 frames standing, 3 of them at the head and 2 at the tail with the arms out.
fn with_t_poses() -> Recording {
    let mut recording = parse(&person(&PERSON, 100, "0.008333333"));
    for frame in [0, 1, 2, 98, 99] {
        let pose = frame * PERSON.len();
        recording.rotations[pose + 8] = Quat::from_rotation_z(1.57);
        recording.rotations[pose + 11] = Quat::from_rotation_z(-1.57);
    }
    recording
}

#[test]
fn t_poses_are_found_and_nothing_else() {
    let recording = with_t_poses();
    let roles = Roles::find(&recording.skeleton).unwrap();
    assert_eq!(tpose::find(&recording, &roles), (3, 2));

    let mut smeared = recording.clone();
    let pose = 3 * PERSON.len();
    smeared.rotations[pose + 8] = Quat::from_rotation_z(0.8);
    smeared.rotations[pose + 11] = Quat::from_rotation_z(-0.8);
    assert_eq!(tpose::find(&smeared, &roles), (10, 2));

    let standing = parse(&person(&PERSON, 100, "0.03333"));
    assert_eq!(tpose::find(&standing, &roles), (0, 0));
    let mut throughout = standing;
    for frame in 0..100 {
        let pose = frame * PERSON.len();
        let t_pose = &recording.rotations[..PERSON.len()];
        throughout.rotations[pose..pose + PERSON.len()].copy_from_slice(t_pose);
    }
    assert_eq!(tpose::find(&throughout, &roles), (0, 0));
}

#[test]
fn manifests_are_tables_with_quotes() {
    let path = Path::new("manifest.csv");
    let text = "file,description,skip_head,skip_tail,unit_m,licence,source\r\n\
        a.bvh,\"walk, \"\"brisk\"\"\",2,,0.01,CC,here\r\n\r\nsub/b.bvh,run,,3,,,\n";
    let manifest = manifest::parse(text, path).unwrap();
    let a = &manifest["a.bvh"];
    assert_eq!((a.skip_head, a.skip_tail, a.unit_m), (2, 0, Some(0.01)));
    assert_eq!((a.licence.as_str(), a.source.as_str()), ("CC", "here"));
    assert_eq!(manifest["sub/b.bvh"].skip_tail, 3);
    for (text, expected) in [
        ("", "line 1: the first row names the columns"),
        (
            "name,skip\na,1\n",
            "line 1: the first row names the columns",
        ),
        (
            "file,skip_head\na,1\nb\n",
            "line 3: 1 fields where the first row names 2",
        ),
        ("file,skip_head\na,x\n", "line 2: skip_head is 'x'"),
        ("file,unit_m\na,0\n", "line 2: unit_m is '0'"),
        ("file,unit_m\na,1\na,1\n", "line 3: a second row for 'a'"),
        (
            "file,unit_m\n\"a,1\n",
            "line 2: a quote that is never closed",
        ),
    ] {
        let message = manifest::parse(text, path).unwrap_err().to_string();
        assert!(message.contains(expected), "{expected} / {message}");
        assert!(message.starts_with("manifest.csv, line"), "{message}");
    }
}

fn failure(path: &Path) -> String {
    import(path, &ImportOptions::default())
        .unwrap_err()
        .to_string()
}

#[test]
fn a_folder_is_imported_by_name() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path().join("set");
    std::fs::create_dir(&folder).unwrap();
    assert!(failure(&folder).contains("no .bvh file in"));
    assert!(failure(&folder.join("absent")).contains("cannot read"));

    let long = person(&PERSON, 300, "0.0083333");
    std::fs::write(folder.join("b.bvh"), &long).unwrap();
    std::fs::write(folder.join("a.BVH"), person(&PERSON, 70, "0.033333")).unwrap();
    std::fs::write(folder.join("c.bvh"), person(&PERSON, 60, "0.033333")).unwrap();
    assert!(
        failure(root.path()).contains("try "),
        "{}",
        failure(root.path())
    );
    assert!(failure(&folder.join("c.bvh")).contains("no usable clip"));

    let all = import(&folder, &ImportOptions::default()).unwrap();
    let names = |import: &ImportedMotion| -> Vec<String> {
        import.clips.iter().map(|c| c.name.clone()).collect()
    };
    assert_eq!(names(&all), ["a", "b"]);
    assert_eq!(all.clips[1].frames(), 75);
    assert!(all.notes[0].contains("c (60)"), "{:?}", all.notes);
    assert!((all.clips[0].positions[0].y - 0.95).abs() < 1e-4);

    // The manifest above the folder speaks of it by its name.
    let rows = "file,skip_head,unit_m,licence\nset/b.bvh,40,0.02,free\n";
    std::fs::write(root.path().join("manifest.csv"), rows).unwrap();
    let mirrored = ImportOptions {
        mirror: true,
        ..ImportOptions::default()
    };
    let listed = import(&folder, &mirrored).unwrap();
    assert_eq!(names(&listed), ["a", "b", "a mirrored", "b mirrored"]);
    let b = &listed.clips[1];
    assert_eq!((b.frames(), b.licence.as_str()), (65, "free"));
    assert!((b.positions[0].y - 1.9).abs() < 1e-4);
    let given = ImportOptions {
        unit_m: Some(0.03),
        ..ImportOptions::default()
    };
    let given = import(&folder.join("b.bvh"), &given).unwrap();
    assert!((given.clips[0].positions[0].y - 2.85).abs() < 1e-4);

    std::fs::write(folder.join("d.bvh"), long.replace("RightHand", "RightFist")).unwrap();
    let message = failure(&folder);
    let expected = "joint 14: 'RightHand' under 'RightForeArm' against 'RightFist'";
    assert!(
        message.contains("a.BVH and ") && message.contains("d.bvh differ"),
        "{message}"
    );
    assert!(message.contains(expected), "{message}");

    std::fs::write(folder.join("d.bvh"), &long[..long.len() / 2]).unwrap();
    assert!(failure(&folder).contains("d.bvh, line"));
}
