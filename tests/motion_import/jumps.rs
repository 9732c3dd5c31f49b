//! Rest poses, takes that were joined, moments at which the actor was lost.

use super::{PERSON, assert_walks, import_one, v, walking};
use footwork::motion::clip::Clip;
use footwork::motion::import::ImportOptions;
use glam::{Quat, Vec3};

/// The pose with both arms raised sideways by an angle.
fn arms(angle: f32) -> Vec<Quat> {
    let mut pose = vec![Quat::IDENTITY; PERSON.len()];
    pose[8] = Quat::from_rotation_z(angle);
    pose[11] = Quat::from_rotation_z(-angle);
    pose
}

/// The clip with frames of one pose before it or after it.
fn with_rest(mut clip: Clip, frames: usize, pose: &[Quat], at: Vec3, before: bool) -> Clip {
    let index = if before { 0 } else { clip.positions.len() };
    let joints = index * PERSON.len();
    clip.positions.splice(index..index, vec![at; frames]);
    clip.rotations.splice(joints..joints, pose.repeat(frames));
    clip
}

fn imported(clip: &Clip) -> (Clip, Vec<String>) {
    let mut import = import_one(clip, &ImportOptions::default()).unwrap();
    (import.clips.remove(0), import.notes)
}

fn refused(clip: &Clip) -> String {
    let error = import_one(clip, &ImportOptions::default()).unwrap_err();
    error.to_string()
}

#[test]
fn rest_poses_of_any_shape_are_dropped_at_either_end() {
    let mut walk = walking(90);
    walk.positions
        .iter_mut()
        .for_each(|p| *p += v(3.0, 0.0, 2.0));
    for angle in [0.0, 0.8, 1.57, 3.0] {
        for frames in [1, 2, 20, 75] {
            for before in [true, false] {
                let clip = with_rest(walk.clone(), frames, &arms(angle), Vec3::ZERO, before);
                let (found, notes) = imported(&clip);
                let what = format!("{angle} {frames} {before} {notes:?}");
                assert_eq!(found.frames(), 90, "{what}");
                assert_walks(&found);
                let told = notes[0].contains(&format!("walk ({frames}"));
                assert!(
                    notes.len() == 1 && notes[0].contains("frames dropped") && told,
                    "{what}"
                );
            }
        }
    }
}

#[test]
fn a_rest_pose_on_the_spot_is_dropped_too() {
    let walk = walking(90);
    let start = walk.positions[0];
    for angle in [0.8, 1.57, 3.0] {
        let (found, notes) = imported(&with_rest(walk.clone(), 1, &arms(angle), start, true));
        assert_eq!(found.frames(), 90, "{angle} {notes:?}");
    }
    // Whoever begins with the arms down has not jumped.
    let (found, notes) = imported(&with_rest(walk.clone(), 1, &arms(0.0), start, true));
    assert_eq!((found.frames(), notes.len()), (91, 0), "{notes:?}");
}

#[test]
fn a_rest_pose_before_a_t_pose_is_dropped_with_it() {
    let mut walk = walking(90);
    walk.positions.iter_mut().for_each(|p| p.x += 3.0);
    let start = walk.positions[0];
    let posed = with_rest(walk, 40, &arms(1.57), start, true);
    for frames in [1, 3, 40] {
        for angle in [0.0, 1.57] {
            let clip = with_rest(posed.clone(), frames, &arms(angle), Vec3::ZERO, true);
            let (found, notes) = imported(&clip);
            assert_eq!(found.frames(), 90, "{frames} {angle}: {notes:?}");
            assert_walks(&found);
        }
    }
}

#[test]
fn arms_held_out_are_no_rest_pose() {
    let mut walk = walking(150);
    for pose in walk.rotations.chunks_exact_mut(PERSON.len()) {
        pose[8] = Quat::from_rotation_z(1.57);
        pose[11] = Quat::from_rotation_z(-1.57);
    }
    let (found, notes) = imported(&walk);
    assert_eq!((found.frames(), notes.len()), (150, 0), "{notes:?}");
    // Only the seconds before the first step are one.
    let start = walk.positions[0];
    let (found, notes) = imported(&with_rest(walk, 40, &arms(1.57), start, true));
    assert!((148..=150).contains(&found.frames()), "{notes:?}");
    assert!(
        notes[0].starts_with("T-pose frames dropped: walk ("),
        "{notes:?}"
    );
}

#[test]
fn takes_that_were_joined_are_refused_or_cut() {
    let mut clip = walking(200);
    clip.positions[120..].iter_mut().for_each(|p| p.x += 0.4);
    let message = refused(&clip);
    for part in [
        "walk.bvh",
        "the motion jumps",
        "0.40 m after frame 120;",
        "--trim",
    ] {
        assert!(message.contains(part), "{part} / {message}");
    }
    let trim = ImportOptions {
        trim: true,
        ..ImportOptions::default()
    };
    let import = import_one(&clip, &trim).unwrap();
    assert_eq!(import.clips[0].frames(), 120);
    assert_walks(&import.clips[0]);
    let note =
        "trimmed to the longest piece without a jump: walk (80 frames, 0.40 m after frame 120)";
    assert_eq!(import.notes, [note]);

    // A moment at which the actor was lost.
    for frames in [1, 5] {
        let mut lost = walking(200);
        lost.positions.iter_mut().for_each(|p| p.x += 2.0);
        lost.positions[90..90 + frames].fill(Vec3::ZERO);
        let message = refused(&lost);
        assert!(message.contains("after frame 90, "), "{message}");
        let import = import_one(&lost, &trim).unwrap();
        assert_eq!(import.clips[0].frames(), 110 - frames);
    }
    // Another pose from one frame to the next, on the spot.
    let mut posed = walking(200);
    for pose in posed.rotations.chunks_exact_mut(PERSON.len()).skip(100) {
        pose.copy_from_slice(&arms(2.0));
    }
    assert!(refused(&posed).contains("after frame 100;"));
}

#[test]
fn what_a_body_can_do_is_no_jump() {
    // From standing to a sprint of 10 m/s within a second and a half, at several rates.
    for rate in [30.0, 60.0, 120.0] {
        let mut clip = walking((5.0 * rate) as usize);
        clip.rate = rate;
        for (frame, position) in clip.positions.iter_mut().enumerate() {
            let t = (frame as f32 / rate - 1.0).max(0.0);
            let sprint = if t < 1.5 {
                t * t * 10.0 / 3.0
            } else {
                7.5 + (t - 1.5) * 10.0
            };
            *position = v(0.0, 0.87, sprint);
        }
        let (found, notes) = imported(&clip);
        assert_eq!((found.frames(), notes.len()), (150, 0), "{rate}: {notes:?}");
    }
    // A punch: the arm goes out within 0.1 s and back.
    let mut clip = walking(90);
    for (frame, turn) in [
        (40, 0.4),
        (41, 1.0),
        (42, 1.5),
        (43, 1.4),
        (44, 0.8),
        (45, 0.3),
    ] {
        clip.rotations[frame * PERSON.len() + 8] = Quat::from_rotation_x(-turn);
    }
    let (found, notes) = imported(&clip);
    assert_eq!((found.frames(), notes.len()), (90, 0), "{notes:?}");
    // One hand alone, out and back within one frame: told, and nobody's loss.
    clip.rotations[60 * PERSON.len() + 8] = Quat::from_rotation_x(-2.5);
    let (found, notes) = imported(&clip);
    assert_eq!((found.frames(), notes.len()), (90, 1), "{notes:?}");
    assert!(notes[0].contains("a hand or a foot jumps"), "{notes:?}");
}
