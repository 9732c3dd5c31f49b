//! Motion as BVH files.

use super::motion::KINDS;
use footwork::motion::bvh;
use footwork::motion::import::{ImportOptions, import_file};

#[test]
fn an_episode_is_read_back_to_the_same_poses() {
    for run in KINDS.iter() {
        let kind = &run.name;
        let path = run.kept("bvh", "bvh");
        let clip = &run.characters()[0].clip;
        let read = bvh::read(&path).unwrap();
        assert_eq!(read.skeleton.names, clip.skeleton.names, "{kind}");
        assert_eq!(read.skeleton.parents, clip.skeleton.parents, "{kind}");
        assert_eq!(read.frames(), clip.frames(), "{kind}");
        assert!((read.rate - clip.rate).abs() < 1e-3, "{kind}");
        for frame in 0..clip.frames() {
            let away = read.positions[frame] * 0.01 - clip.positions[frame];
            assert!(away.length() < 1e-5, "{kind}, frame {frame}: {away}");
            for (joint, (read, own)) in read.pose(frame).iter().zip(clip.pose(frame)).enumerate() {
                // Of small angles the sine is exact where the cosine is not.
                let between = own.inverse() * *read;
                let degrees = 2.0 * between.xyz().length().asin().to_degrees();
                assert!(
                    degrees < 0.01,
                    "{kind}, frame {frame}, joint {joint}: {degrees}"
                );
            }
        }
    }
}

#[test]
fn episodes_can_be_imported() {
    for run in KINDS.iter() {
        let kind = &run.name;
        let path = run.kept("bvh", "again.bvh");
        let clip = &run.characters()[0].clip;
        let read = import_file(&path, &ImportOptions::default()).unwrap();
        let hips = read.clip.positions[0].y;
        assert!(
            (hips - clip.positions[0].y).abs() < 1e-3,
            "{kind}: {hips} m"
        );
        let name = |joint: usize| read.clip.skeleton.names[joint].to_lowercase();
        for (joint, part) in [
            (read.roles.left_foot, "left"),
            (read.roles.right_hip, "right"),
        ] {
            assert!(name(joint).contains(part), "{kind}: {}", name(joint));
        }
    }
}
