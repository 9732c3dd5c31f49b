//! Is this a person standing up: axes, sizes, motion in place.

use super::{PERSON, assert_walks, import_all, import_one, v, walking};
use footwork::motion::clip::Clip;
use footwork::motion::import::ImportOptions;
use footwork::motion::up::UpAxis;
use glam::{Quat, Vec3};

/// The rotation that takes y to an axis.
fn from_y(axis: UpAxis) -> Quat {
    match axis {
        UpAxis::MinusY => Quat::from_rotation_x(std::f32::consts::PI),
        axis => Quat::from_rotation_arc(Vec3::Y, axis.direction()),
    }
}

/// The clip in a world turned so that y becomes `axis`; the joints' own axes stay.
fn lying(mut clip: Clip, axis: UpAxis) -> Clip {
    let turn = from_y(axis);
    let joints = clip.skeleton.joints();
    clip.positions.iter_mut().for_each(|p| *p = turn * *p);
    for pose in clip.rotations.chunks_exact_mut(joints) {
        pose[0] = turn * pose[0];
    }
    clip
}

/// The clip with all axes turned: the rest pose stands along `axis` too.
fn exported(mut clip: Clip, axis: UpAxis) -> Clip {
    let turn = from_y(axis);
    clip.positions.iter_mut().for_each(|p| *p = turn * *p);
    clip.skeleton
        .offsets
        .iter_mut()
        .for_each(|o| *o = turn * *o);
    clip.rotations
        .iter_mut()
        .for_each(|r| *r = turn * *r * turn.inverse());
    clip
}

/// The walk on one place.
fn standing(frames: usize) -> Clip {
    let mut clip = walking(frames);
    clip.positions.fill(v(0.0, 0.87, 0.0));
    clip
}

fn with_up(up: UpAxis) -> ImportOptions {
    ImportOptions {
        up: Some(up),
        ..ImportOptions::default()
    }
}

#[test]
fn every_axis_can_be_up() {
    for axis in UpAxis::ALL {
        for clip in [exported(walking(90), axis), lying(walking(200), axis)] {
            let import = import_one(&clip, &ImportOptions::default()).unwrap();
            assert_walks(&import.clips[0]);
            assert_eq!(import.findings[0].up, Some(axis));
            let told = import
                .notes
                .iter()
                .any(|note| note.contains("turned, since up was"));
            assert_eq!(told, axis != UpAxis::Y, "{:?}", import.notes);
            let given = import_one(&clip, &with_up(axis)).unwrap();
            assert_eq!(given.clips, import.clips);
        }
    }
}

#[test]
fn who_lies_or_stands_is_asked() {
    let clip = lying(standing(90), UpAxis::Z);
    let message = import_one(&clip, &ImportOptions::default())
        .unwrap_err()
        .to_string();
    for part in [
        "walk.bvh",
        "unclear which way is up",
        "in 100 % of the frames",
        "along z",
        "--up AXIS",
    ] {
        assert!(message.contains(part), "{part} / {message}");
    }
    let lies = import_one(&clip, &with_up(UpAxis::Y)).unwrap();
    assert!(lies.clips[0].positions[0].distance(clip.positions[0]) < 1e-4);
    let stands = import_one(&clip, &with_up(UpAxis::Z)).unwrap();
    assert!(stands.clips[0].positions[0].distance(v(0.0, 0.87, 0.0)) < 1e-4);

    // The folder's other clips answer.
    let (walk, turned) = (walking(90), exported(walking(90), UpAxis::Z));
    for (other, axis) in [(&walk, UpAxis::Y), (&turned, UpAxis::Z)] {
        let both = import_all(&[("a", &clip), ("b", other)], &ImportOptions::default()).unwrap();
        let up = both.findings.iter().map(|findings| findings.up);
        assert!(up.eq([Some(axis); 2]), "{:?}", both.findings);
    }
}

#[test]
fn who_neither_stands_nor_lies_is_taken_as_most_files_are() {
    let mut clip = walking(90);
    for (frame, pose) in clip.rotations.chunks_exact_mut(PERSON.len()).enumerate() {
        pose[0] = Quat::from_rotation_x(1.2 + 0.8 * (frame as f32 * 0.1).sin());
    }
    let import = import_one(&clip, &ImportOptions::default()).unwrap();
    assert_eq!(import.findings[0].up, Some(UpAxis::Y));
}

/// The clip with lengths multiplied. Files are in centimetres.
fn scaled(mut clip: Clip, scale: f32) -> Clip {
    clip.positions.iter_mut().for_each(|p| *p *= scale);
    clip.skeleton.offsets.iter_mut().for_each(|o| *o *= scale);
    clip
}

#[test]
fn small_and_large_people_keep_their_size() {
    // Legs of 0.82 m. How large the person is, the unit of the file, and whether it is unusual.
    for (size, unit, unusual) in [
        (1.0, 0.01, false),
        (1.0, 1.0, false),
        (1.0, 0.1, false),
        (1.0, 0.0254, true),
        (1.0, 0.001, false),
        (0.52, 0.01, true),
        (0.52, 1.0, true),
        (0.32, 0.01, true),
        (0.62, 1.0, true),
        (1.5, 0.01, true),
    ] {
        let clip = scaled(walking(90), size * 0.01 / unit);
        let import = import_one(&clip, &ImportOptions::default()).unwrap();
        assert_eq!(import.findings[0].unit_m, Some(unit), "{size} {unit}");
        let height = import.clips[0].positions[0].y;
        assert!(
            (height - 0.87 * size).abs() < 1e-3,
            "{size} {unit}: {height}"
        );
        let note = import.notes.join(" ");
        assert_eq!(
            note.contains("unusual size"),
            unusual,
            "{size} {unit}: {note}"
        );
        if unusual {
            let figures = format!("legs of {:.2} m with a unit of {unit} m", 0.82 * size);
            assert!(note.contains(&figures), "{figures} / {note}");
        }
    }
    let given = ImportOptions {
        unit_m: Some(0.01),
        ..ImportOptions::default()
    };
    let import = import_one(&scaled(walking(90), 0.5), &given).unwrap();
    assert!(import.notes.is_empty(), "{:?}", import.notes);
}

#[test]
fn a_folder_has_one_unit() {
    let walk = walking(90);
    // Alone, the small one would be a tall person in inches or a child in centimetres.
    for small in [0.32, 0.35, 0.5, 0.52] {
        let child = scaled(walking(90), small);
        let alone = import_one(&child, &ImportOptions::default()).unwrap();
        assert!(alone.notes[0].contains("unusual size"), "{small}");
        let import = import_all(
            &[("adult", &walk), ("child", &child)],
            &ImportOptions::default(),
        )
        .unwrap();
        let units = import.findings.iter().map(|findings| findings.unit_m);
        assert!(units.eq([Some(0.01); 2]), "{small}: {:?}", import.findings);
    }
    // Files that cannot have one unit have two, with a note.
    let metres = scaled(walking(90), 0.01);
    let import = import_all(&[("cm", &walk), ("m", &metres)], &ImportOptions::default()).unwrap();
    for clip in &import.clips {
        assert_walks(clip);
    }
    let note = "different units in one folder: cm (0.01 m), m (1 m)";
    assert!(
        import.notes.iter().any(|found| found == note),
        "{:?}",
        import.notes
    );
}

#[test]
fn motion_on_the_spot_is_told() {
    let import = import_one(&standing(90), &ImportOptions::default()).unwrap();
    assert!(
        import.notes[0].contains("the root stays in place"),
        "{:?}",
        import.notes
    );
    assert!(import.findings[0].notes[0].contains("moves by 0.00 m"));
    let mut frozen = standing(90);
    frozen.rotations.fill(Quat::IDENTITY);
    let import = import_one(&frozen, &ImportOptions::default()).unwrap();
    assert_eq!(import.notes, ["nothing moves: walk"]);
}

#[test]
fn feet_off_the_ground_are_told() {
    for (height, told) in [
        (0.0, None),
        (0.8, Some("0.80 m above")),
        (-0.87, Some("0.87 m below")),
    ] {
        let mut clip = walking(90);
        clip.positions.iter_mut().for_each(|p| p.y += height);
        let import = import_one(&clip, &ImportOptions::default()).unwrap();
        assert_eq!(
            import.notes.len(),
            usize::from(told.is_some()),
            "{:?}",
            import.notes
        );
        assert!(
            import
                .notes
                .iter()
                .all(|note| note.contains(told.unwrap_or_default())),
            "{:?}",
            import.notes
        );
    }
}

#[test]
fn exchanged_sides_are_refused_with_the_roles_that_settle_it() {
    let joints = [
        &PERSON[..4],
        &[("LeftToe", 3, v(0.0, -0.05, 0.13))],
        &[("RightUpLeg", 0, v(-0.1, -0.05, 0.0))],
        &[("RightLeg", 5, v(0.0, -0.42, 0.0))],
        &[("RightFoot", 6, v(0.0, -0.40, 0.0))],
        &[("RightToe", 7, v(0.0, -0.05, 0.13))],
        &[("Spine", 0, v(0.0, 0.3, 0.0))],
        &[("LeftArm", 9, v(0.15, 0.2, 0.0))],
        &[("LeftForeArm", 10, v(0.0, -0.3, 0.0))],
        &[("LeftHand", 11, v(0.0, -0.25, 0.0))],
        &[("RightArm", 9, v(-0.15, 0.2, 0.0))],
        &[("RightForeArm", 13, v(0.0, -0.3, 0.0))],
        &[("RightHand", 14, v(0.0, -0.25, 0.0))],
    ]
    .concat();
    let mut clip = Clip {
        skeleton: super::skeleton(&joints),
        rotations: vec![Quat::IDENTITY; 90 * joints.len()],
        ..walking(90)
    };
    import_one(&clip, &ImportOptions::default()).unwrap();
    for name in &mut clip.skeleton.names {
        *name = match name.strip_prefix("Left") {
            Some(part) => format!("Right{part}"),
            None => name.replace("Right", "Left"),
        };
    }
    let message = import_one(&clip, &ImportOptions::default())
        .unwrap_err()
        .to_string();
    for part in [
        "walk.bvh",
        "in 100 % of the frames the toes point backwards",
        "--roles FILE",
    ] {
        assert!(message.contains(part), "{part} / {message}");
    }
    let (_, file) = message.split_once("\n\n").unwrap();
    assert!(file.contains("left_foot = \"RightFoot\"\n"), "{file}");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("roles.toml");
    std::fs::write(&path, file).unwrap();
    let exchanged = ImportOptions {
        roles: Some(path),
        ..ImportOptions::default()
    };
    import_one(&clip, &exchanged).unwrap();
}
