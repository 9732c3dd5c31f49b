//! A database in parts.

use crate::PLANE;
use footwork::motion::database::Database;
use footwork::motion::features::{FEATURE_DIM, MIN_FUTURE_FRAMES};
use footwork::playback::player::Feet;
use footwork::web::locomotion_run::part_name;
use footwork::web::motion_parts::MotionHeader;

struct Parts {
    header: MotionHeader,
    parts: Vec<Vec<u8>>,
    /// Frames of the database, in the order of those of the parts.
    frames: Vec<usize>,
    feet: Feet,
}

/// The database in parts, its clips from the last to the first.
fn parts() -> Parts {
    let database = &PLANE.matcher.database;
    let feet = Feet::of(database);
    let order: Vec<usize> = (0..database.clips.len()).rev().collect();
    let (header, parts) = MotionHeader::cut(database, &feet, &order).expect("parts");
    let clips = order.iter().map(|&clip| &database.clips[clip]);
    let frames = clips.flat_map(|clip| clip.first..clip.first + clip.frames);
    Parts {
        header,
        parts,
        frames: frames.collect(),
        feet,
    }
}

#[test]
fn what_arrives_is_what_was_cut_within_half_a_step_of_sixteen_bits() {
    let original = &PLANE.matcher.database;
    let Parts {
        header,
        parts,
        frames,
        feet: original_feet,
    } = parts();
    assert!(parts.len() > 1, "of one part nothing could be learned");
    let (mut database, mut feet) = header.empty();
    for (number, part) in parts.iter().enumerate() {
        let added = header.append(&mut database, &mut feet, &part_name(number), part);
        added.expect("the next part");
    }
    assert_eq!(database.frames(), original.frames());
    let joints = original.skeleton.joints();
    let (mut feature, mut hips, mut turn) = (0.0f32, 0.0f32, 0.0f32);
    for (at, &frame) in frames.iter().enumerate() {
        for column in 0..FEATURE_DIM {
            let off = database.features[at][column] - original.features[frame][column];
            feature = feature.max(off.abs());
        }
        hips = hips.max(database.hips[at].distance(original.hips[frame]));
        for joint in 0..joints {
            let [near, exact] = [
                database.rotations[at * joints + joint],
                original.rotations[frame * joints + joint],
            ];
            turn = turn.max(near.angle_between(exact).to_degrees());
        }
        assert_eq!(feet.contacts[at], original_feet.contacts[frame]);
    }
    assert!(feature < 5e-4, "features, normalised: {feature}");
    assert!(hips < 1e-3, "hips: {hips} m");
    assert!(turn < 0.1, "joints: {turn} degrees");
    assert_eq!(feet.legs, original_feet.legs);
    assert_eq!(database.candidates.len(), original.candidates.len());
    assert_eq!(database.motion.len(), original.motion.len());
}

#[test]
fn parts_up_to_one_are_a_database_whose_candidates_stay() {
    let Parts { header, parts, .. } = parts();
    let (mut database, mut feet) = header.empty();
    let mut before: Vec<u32> = Vec::new();
    for (number, part) in parts.iter().enumerate() {
        let added = header.append(&mut database, &mut feet, &part_name(number), part);
        added.expect("the next part");
        assert!(database.candidates.len() > before.len());
        assert_eq!(database.candidates[..before.len()], before);
        check(&database);
        before.clone_from(&database.candidates);
    }
}

/// Every candidate's future is there.
fn check(database: &Database) {
    for &frame in &database.candidates {
        let clip = database.clip(frame as usize);
        assert!(frame as usize + MIN_FUTURE_FRAMES < clip.first + clip.frames);
        assert!(clip.first + clip.frames <= database.frames());
    }
}

#[test]
fn damaged_and_unordered_parts_are_refused() {
    let Parts { header, parts, .. } = parts();
    let (mut database, mut feet) = header.empty();
    let mut append = |bytes: &[u8]| {
        let added = header.append(&mut database, &mut feet, "motion-000.footwork", bytes);
        added.expect_err("a part that is not the next").to_string()
    };
    let mut damaged = parts[0].clone();
    damaged[100_000] ^= 1;
    assert!(append(&damaged).contains("motion-000.footwork is damaged"));
    assert!(append(&parts[0][..100_000]).contains("damaged"), "cut off");
    assert!(append(b"<!DOCTYPE html>").contains("not a footwork"));
    let last = parts.last().expect("parts");
    assert!(
        append(last).contains("numbers, not"),
        "the last one is shorter"
    );
}
