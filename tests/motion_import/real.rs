//! Real recordings, where there are some.

use super::mocap::recordings;
use super::{assert_same_motion, parse, v};
use footwork::motion::bvh;
use footwork::motion::clip::Clip;
use footwork::motion::import::{ImportOptions, MIN_FRAMES, import};
use footwork::motion::mirror::mirror;
use footwork::motion::roles::Roles;
use footwork::motion::{manifest, tpose, units};

/// Folders, how their manifest calls them, clips and frames at 30 Hz that must come out.
const FOLDERS: [(&str, &str, &str, usize, usize); 7] = [
    ("lafan1", "lafan1", "", 137, 69_127),
    ("pfnn15", "pfnn15", "", 9, 42_241),
    ("cmu/mb31", "cmu", "mb31/", 26, 2_630),
    ("cmu/daz43", "cmu", "daz43/", 44, 6_230),
    ("boxing/snu15", "boxing", "snu15/", 2, 1_674),
    ("boxing/daz43_karate", "boxing", "daz43_karate/", 8, 4_448),
    ("boxing/mb31", "boxing", "mb31/", 1, 464),
];

#[test]
fn real_recordings_import() {
    let Some(mocap) = recordings("") else { return };
    for (folder, _, _, clips, frames) in FOLDERS {
        let import = import(&mocap.join(folder), &ImportOptions::default()).unwrap();
        let found: usize = import.clips.iter().map(Clip::frames).sum();
        assert_eq!((import.clips.len(), found), (clips, frames), "{folder}");
        for clip in &import.clips {
            assert!(clip.frames() >= MIN_FRAMES && clip.rate == 30.0);
            assert!(!clip.licence.is_empty() && !clip.source.is_empty());
            let mut heights: Vec<f32> = clip.positions.iter().map(|p| p.y).collect();
            heights.sort_by(f32::total_cmp);
            let median = heights[heights.len() / 2];
            assert!((0.5..1.15).contains(&median), "{}: {median}", clip.name);
        }
    }
}

#[test]
fn what_is_found_agrees_with_the_manifests() {
    let Some(mocap) = recordings("") else { return };
    for (folder, above, prefix, ..) in FOLDERS {
        let listing = mocap.join(above).join("manifest.csv");
        let manifest::ManifestFile::Ours(listing) = manifest::read(&listing).unwrap() else {
            panic!("no manifest in {above}");
        };
        let entries = listing.iter().filter_map(|(file, entry)| {
            let file = file.strip_prefix(prefix)?;
            let path = mocap.join(folder).join(file);
            path.is_file().then_some((path, entry))
        });
        let mut compared = 0;
        for (path, entry) in entries {
            let recording = bvh::read(&path).unwrap();
            let roles = Roles::find(&recording.skeleton).unwrap();
            let unit = units::find(&recording.skeleton, &roles).unwrap();
            assert_eq!(Some(unit), entry.unit_m, "{}", path.display());
            // Where a T-pose ends is a matter of taste within the second it takes to leave it.
            let (head, tail) = tpose::find(&recording, &roles);
            let close = |found: usize, listed: usize| {
                (found == 0) == (listed == 0)
                    && found.abs_diff(listed) as f32 <= 0.7 * recording.rate
            };
            let both = close(head, entry.skip_head) && close(tail, entry.skip_tail);
            assert!(both, "{}: {head} {tail} {entry:?}", path.display());
            compared += 1;
        }
        assert!(compared > 0, "{folder}");
    }
}

#[test]
fn real_recordings_survive_writing_and_mirroring() {
    let Some(mocap) = recordings("") else { return };
    for (folder, ..) in FOLDERS {
        let import = import(&mocap.join(folder), &ImportOptions::default()).unwrap();
        let clip = &import.clips[0];
        let text = bvh::to_text(clip).unwrap();
        let back = parse(&text).into_clip(&clip.name, 0.01, 0..clip.frames());
        assert_same_motion(clip, &back);

        let seen = mirror(clip).unwrap();
        assert_eq!(&mirror(&seen).unwrap(), clip, "{folder}");
        let roles = import.roles;
        for frame in (0..clip.frames()).step_by(10) {
            let ((p, _), (q, _)) = (clip.world(frame), seen.world(frame));
            let expected = p[roles.right_foot] * v(-1.0, 1.0, 1.0);
            assert!(
                q[roles.left_foot].distance(expected) < 1e-4,
                "{folder} {frame}"
            );
        }
    }
}
