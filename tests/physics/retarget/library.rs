//! Motions drawn by weight, at any time.

use super::performed;
use footwork::kernels::rng::{random4, uniform01};
use footwork::motion::bvh;
use footwork::motion::clip::Clip;
use footwork::motion::import::ImportOptions;
use footwork::motion::roles::Roles;
use footwork::physics::humanoid::{humanoid, punching_box};
use footwork::physics::kinematics::quaternion;
use footwork::physics::model::Model;
use footwork::physics::motion_library::{MotionLibrary, MotionLibraryError};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Motions of 4, 2 and 1 seconds.
fn clips() -> (Vec<Clip>, Roles) {
    let (clip, roles) = performed();
    let joints = clip.skeleton.joints();
    let clips = [121, 61, 31].map(|frames| {
        let mut clip = clip.clone();
        clip.positions.truncate(frames);
        clip.rotations.truncate(frames * joints);
        clip
    });
    (clips.to_vec(), roles)
}

fn library() -> (Arc<Model>, MotionLibrary) {
    let model = Arc::new(humanoid());
    let (clips, roles) = clips();
    let library = MotionLibrary::of(&clips, &roles, &model);
    (model, library.expect("three motions"))
}

fn load<P: AsRef<Path>>(
    paths: &[P],
    model: &Arc<Model>,
) -> Result<MotionLibrary, MotionLibraryError> {
    MotionLibrary::load(paths, &ImportOptions::default(), model)
}

#[test]
fn pieces_of_a_motion_are_all_of_it() {
    let (model, library) = library();
    let whole = &library.motions()[0];
    for (seconds, count) in [(1.0, 4), (1.5, 3), (30.0, 1)] {
        let pieces = whole.pieces(&model, seconds);
        let joined: Vec<f32> = pieces.iter().flat_map(|piece| piece.q.clone()).collect();
        assert_eq!((pieces.len(), &joined), (count, &whole.q));
        let lengths = pieces.iter().map(|piece| piece.frames);
        let (least, most) = (lengths.clone().min(), lengths.max());
        assert!(most <= least.map(|least| least + 1), "{least:?} {most:?}");
        assert!(pieces.iter().all(|piece| piece.rate == whole.rate));
        assert!(pieces[count - 1].name.ends_with(&format!(".{}", count - 1)));
    }
}

#[test]
fn motions_are_drawn_by_weight_and_times_evenly() {
    const DRAWS: u32 = 200_000;
    let (_, library) = library();
    let weighted = library.clone().weighted(&[0.0, 1.0, 3.0]).expect("weights");
    for (library, shares) in [
        (&library, [4.0 / 7.0, 2.0 / 7.0, 1.0 / 7.0]),
        (&weighted, [0.0, 0.25, 0.75]),
    ] {
        let mut counts = [0u32; 3];
        let mut moments = [[0.0f64; 2]; 3];
        for draw in 0..DRAWS {
            let bits = random4(5, draw, 0, 1);
            let (motion, time) = library.sample([bits[0], bits[1]].map(uniform01));
            let part = f64::from(time / library.motions()[motion].seconds());
            assert!((0.0..1.0).contains(&part));
            counts[motion] += 1;
            moments[motion][0] += part;
            moments[motion][1] += part * part;
        }
        for ((count, share), [mean, square]) in counts.into_iter().zip(shares).zip(moments) {
            let n = f64::from(DRAWS);
            let std = (n * share * (1.0 - share)).sqrt();
            assert!((f64::from(count) - n * share).abs() <= 4.0 * std, "{count}");
            if count > 0 {
                let count = f64::from(count);
                assert!((mean / count - 0.5).abs() < 4.0 / (12.0 * count).sqrt());
                assert!((square / count - 1.0 / 3.0).abs() < 0.01);
            }
        }
    }
}

#[test]
fn between_frames_motion_is_continuous_and_at_frames_exact() {
    let (model, library) = library();
    let motion = &library.motions()[1];
    for frame in 0..motion.frames {
        let (q, v) = library.at(1, frame as f32 / motion.rate);
        let close = |a: &[f32], b: &[f32]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-3);
        assert!(
            close(&q, motion.q(frame)) && close(&v, motion.v(frame)),
            "{frame}"
        );
    }
    let (mut before, _) = library.at(1, 0.0);
    for step in 1..=2000 {
        let (q, v) = library.at(1, step as f32 * motion.seconds() / 2000.0);
        let moved = q.iter().zip(&before).map(|(a, b)| (a - b).abs());
        assert!(moved.fold(0.0, f32::max) < 0.02, "{step}");
        assert!(v.iter().all(|v| v.abs() < 30.0));
        let root = quaternion(&q[3..]);
        assert!((root.length() - 1.0).abs() < 1e-5);
        before = q;
    }
    // Halfway between two frames a quaternion has turned half the angle.
    let (q, _) = library.at(1, 10.5 / motion.rate);
    let hip = model
        .joints
        .iter()
        .find(|joint| joint.name == "left_hip")
        .expect("a hip")
        .q;
    let [a, half, b] = [motion.q(10), &q, motion.q(11)].map(|q| quaternion(&q[hip..]));
    let angle = a.angle_between(b);
    assert!(
        (a.angle_between(half) - angle / 2.0).abs() < 1e-3,
        "{angle}"
    );
    // Before and after there is nothing but the ends.
    assert_eq!(library.at(1, -1.0), library.at(1, 0.0));
    assert_eq!(library.at(1, 99.0), library.at(1, motion.seconds()));
}

#[test]
fn files_and_folders_make_a_library() {
    let folder = tempfile::tempdir().expect("a folder");
    let (clips, _) = clips();
    let write = |clip: &Clip, name: &str| -> PathBuf {
        let path = folder.path().join(name);
        bvh::write(&path, clip).expect("written");
        path
    };
    let model = Arc::new(humanoid());
    let (long, middle) = (write(&clips[0], "a.bvh"), write(&clips[1], "b.bvh"));
    write(&clips[2], "short.bvh");
    let library = load(&[folder.path()], &model).expect("two long enough");
    let frames: Vec<usize> = library
        .motions()
        .iter()
        .map(|motion| motion.frames)
        .collect();
    assert_eq!(frames, [121, 61]);
    assert!(
        library.notes.iter().any(|note| note.contains("short (31)")),
        "{:?}",
        library.notes
    );
    let library = load(&[middle, long], &model).expect("two files");
    assert_eq!(library.motions()[0].frames, 61);
}

#[test]
fn what_makes_no_library_is_said() {
    let model = Arc::new(humanoid());
    let folder = tempfile::tempdir().expect("a folder");
    let refused = |path: PathBuf| load(&[path], &model).expect_err("refused").to_string();
    let none = load::<PathBuf>(&[], &model).expect_err("refused");
    assert!(matches!(none, MotionLibraryError::Empty));
    let error = refused(folder.path().to_path_buf());
    assert!(error.contains("no .bvh file in"), "{error}");
    assert!(refused(folder.path().join("missing.bvh")).contains("missing.bvh"));

    let (clips, roles) = clips();
    let short = folder.path().join("short.bvh");
    bvh::write(&short, &clips[2]).expect("written");
    let error = refused(short);
    assert!(error.contains("61 frames"), "{error}");

    let mut unknown = clips[0].clone();
    for (joint, name) in unknown.skeleton.names.iter_mut().enumerate() {
        *name = format!("bone{joint}");
    }
    // Legs that are not alike are none.
    unknown.skeleton.offsets[roles.left_foot] *= 0.01;
    let path = folder.path().join("unknown.bvh");
    bvh::write(&path, &unknown).expect("written");
    let error = refused(path);
    assert!(
        error.contains("unknown skeleton") && error.contains("unknown.bvh"),
        "{error}"
    );

    let other = Arc::new(punching_box());
    let error = MotionLibrary::of(&clips, &roles, &other).expect_err("refused");
    assert!(
        matches!(error, MotionLibraryError::Retarget { .. }),
        "{error}"
    );
    let library = MotionLibrary::of(&clips, &roles, &model).expect("three motions");
    let motions = library.motions().to_vec();
    let error = MotionLibrary::new(motions, &other).expect_err("refused");
    assert!(matches!(error, MotionLibraryError::Model { .. }), "{error}");
    for weights in [
        &[1.0, 2.0][..],
        &[1.0, -1.0, 1.0],
        &[0.0; 3],
        &[1.0, f32::NAN, 1.0],
        &[f32::MAX; 3],
    ] {
        let error = library.clone().weighted(weights).expect_err("refused");
        let named = matches!(
            error,
            MotionLibraryError::Weights { .. } | MotionLibraryError::Weight { .. }
        );
        assert!(named, "{weights:?}: {error}");
    }
}
