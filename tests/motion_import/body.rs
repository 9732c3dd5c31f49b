//! The body among the joints of a file.

use super::{SPEED, import_one, speeds, walking};
use footwork::motion::bvh;
use footwork::motion::clip::Clip;
use footwork::motion::import::{ImportOptions, import};
use footwork::motion::skeleton::Skeleton;
use glam::{Quat, Vec3};

/// What a joint above the hips carries of their position.
type Carried = fn(Vec3) -> Vec3;

/// The walk with one more joint above the hips, which carries `carried` of what they move.
fn on_a_root(clip: &Clip, carried: impl Fn(Vec3) -> Vec3) -> String {
    let Skeleton {
        names,
        parents,
        offsets,
        ends,
    } = clip.skeleton.clone();
    let joints = names.len() + 1;
    let rooted = Clip {
        skeleton: Skeleton {
            names: std::iter::once("root".to_string()).chain(names).collect(),
            parents: std::iter::once(None)
                .chain(parents.into_iter().map(|p| Some(p.map_or(0, |p| p + 1))))
                .collect(),
            offsets: std::iter::once(Vec3::ZERO).chain(offsets).collect(),
            ends: ends.into_iter().map(|(j, end)| (j + 1, end)).collect(),
        },
        positions: clip.positions.iter().map(|&p| carried(p)).collect(),
        rotations: clip
            .rotations
            .chunks(joints - 1)
            .flat_map(|pose| std::iter::once(Quat::IDENTITY).chain(pose.iter().copied()))
            .collect(),
        ..clip.clone()
    };
    let slides: Vec<Vec3> = clip.positions.iter().map(|&p| p - carried(p)).collect();
    with_slide(&bvh::to_text(&rooted).unwrap(), "Hips", &slides)
}

/// The text with position channels for a joint, which come first in its channels.
fn with_slide(text: &str, joint: &str, slides: &[Vec3]) -> String {
    let (hierarchy, motion) = text.split_once("MOTION").unwrap();
    let before = hierarchy.split(joint).next().unwrap();
    let counts = before.split("CHANNELS ").skip(1);
    let column: usize = counts.map(|rest| rest[..1].parse::<usize>().unwrap()).sum();
    let (start, rest) = hierarchy.split_at(before.len());
    let rest = rest.replacen("CHANNELS 3", "CHANNELS 6 Xposition Yposition Zposition", 1);
    let mut lines = motion.lines();
    let head: Vec<&str> = lines.by_ref().take(3).collect();
    let rows = lines.zip(slides).map(|(line, slide)| {
        let mut words: Vec<String> = line.split_whitespace().map(str::to_string).collect();
        let slide = slide.to_array().map(|x| (100.0 * x).to_string());
        words.splice(column..column, slide);
        words.join(" ")
    });
    let rows: Vec<String> = rows.collect();
    format!(
        "{start}{rest}MOTION{}\n{}\n",
        head.join("\n"),
        rows.join("\n")
    )
}

fn imported(text: &str) -> Result<(Clip, Vec<String>), String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.bvh");
    std::fs::write(&path, text).unwrap();
    let mut import = import(&path, &ImportOptions::default()).map_err(|error| error.to_string())?;
    Ok((import.clips.remove(0), import.notes))
}

#[test]
fn a_root_above_the_hips_keeps_their_motion_whole() {
    let mut walk = walking(90);
    // A bob so small that it could pass for the play of a bone.
    for (frame, position) in walk.positions.iter_mut().enumerate() {
        position.y += 0.01 * (frame as f32 * 0.4).sin();
    }
    let carriers: [(&str, Carried); 4] = [
        ("the root travels", |p| p.with_y(0.0)),
        ("the root stands still", |_| Vec3::ZERO),
        ("the root does everything", |p| p),
        ("both travel", |p| p * 0.5),
    ];
    for (what, carried) in carriers {
        let (clip, notes) = imported(&on_a_root(&walk, carried)).unwrap();
        assert!(notes.is_empty(), "{notes:?}");
        assert_eq!(clip.skeleton.names, walk.skeleton.names, "{what}");
        for (frame, (a, b)) in clip.positions.iter().zip(&walk.positions).enumerate() {
            assert!(a.distance(*b) < 1e-4, "{what}, frame {frame}: {a} {b}");
        }
        let (mean, _) = speeds(&clip);
        assert!((mean - SPEED).abs() < 0.01, "{what}: {mean}");
    }
}

#[test]
fn a_turned_root_turns_the_body() {
    let mut walk = walking(90);
    let turn = Quat::from_rotation_y(0.7);
    walk.skeleton.names.insert(0, "Armature".to_string());
    walk.skeleton.parents = std::iter::once(None)
        .chain(
            walk.skeleton
                .parents
                .iter()
                .map(|p| Some(p.map_or(0, |p| p + 1))),
        )
        .collect();
    walk.skeleton.offsets.insert(1, Vec3::new(0.0, 0.2, 0.1));
    walk.skeleton.offsets[0] = Vec3::ZERO;
    let poses = walk
        .rotations
        .chunks(14)
        .map(|pose| [&[turn], pose].concat());
    walk.rotations = poses.flatten().collect();
    let import = import_one(&walk, &ImportOptions::default()).unwrap();
    let clip = &import.clips[0];
    assert_eq!(clip.skeleton.names[0], "Hips");
    for frame in [0, 40, 89] {
        let (expected, _) = walk.world(frame);
        let (found, _) = clip.world(frame);
        for (joint, place) in found.iter().enumerate() {
            assert!(
                place.distance(expected[joint + 1]) < 1e-3,
                "{frame} {joint}"
            );
        }
    }
}

#[test]
fn joints_beside_the_body_are_left_out_with_a_note() {
    let walk = walking(90);
    let text = on_a_root(&walk, |p| p.with_y(0.0));
    let far: Vec<Vec3> = (0..90).map(|f| Vec3::X * (f as f32 * 0.1).sin()).collect();
    let helper =
        "JOINT ik_foot_l\n{\nOFFSET 0 0 0\nCHANNELS 3 Zrotation Yrotation Xrotation\n}\n}\nMOTION";
    // The helper's columns are the last ones.
    let with_helper = text.replacen("}\nMOTION", helper, 1);
    let (head, rows) = with_helper.split_once("Frame Time").unwrap();
    let mut lines = rows.lines();
    let time = lines.next().unwrap();
    let rows: Vec<String> = lines.map(|line| format!("{line} 0 0 0")).collect();
    let text = format!("{head}Frame Time{time}\n{}\n", rows.join("\n"));
    let (clip, notes) = imported(&with_slide(&text, "ik_foot_l", &far)).unwrap();
    assert_eq!(clip.skeleton.names, walk.skeleton.names);
    let note = "joints outside of the body left out: walk (ik_foot_l)";
    assert_eq!(notes, [note]);

    // A prop that slides in the hand is no part of the body either, but a foot that does is.
    let prop = "JOINT sword\n{\nOFFSET 0 10 0\nCHANNELS 3 Zrotation Yrotation Xrotation\n}\n";
    let plain = bvh::to_text(&walk).unwrap();
    let (before, after) = plain.split_once("JOINT RightArm").unwrap();
    let (hand, rest) = after.split_once("RightHand").unwrap();
    let (brace, rest) = rest.split_once("End Site").unwrap();
    let hierarchy = format!("{before}JOINT RightArm{hand}RightHand{brace}{prop}End Site{rest}");
    let (head, rows) = hierarchy.split_once("Frame Time").unwrap();
    let mut lines = rows.lines();
    let time = lines.next().unwrap();
    let rows: Vec<String> = lines.map(|line| format!("{line} 0 0 0")).collect();
    let text = format!("{head}Frame Time{time}\n{}\n", rows.join("\n"));
    let (clip, notes) = imported(&with_slide(&text, "sword", &far)).unwrap();
    assert_eq!(clip.skeleton.names, walk.skeleton.names);
    assert!(notes[0].contains("sword"), "{notes:?}");

    for (joint, far) in [("RightFoot", 1.0), ("Spine", 0.3), ("LeftForeArm", 0.5)] {
        let slides: Vec<Vec3> = (0..90)
            .map(|f| Vec3::Y * far * (1.0 + (f as f32).sin()))
            .collect();
        let message = imported(&with_slide(&plain, joint, &slides)).unwrap_err();
        let expected = format!("the joint '{joint}' moves by");
        assert!(message.contains(&expected), "{message}");
        assert!(
            message.contains("bones must keep their length"),
            "{message}"
        );
    }
}
