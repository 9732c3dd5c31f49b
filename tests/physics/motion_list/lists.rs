//! What lists, folders and single files give.

use super::{Folder, climbing, load, load_with, names, standing};
use footwork::motion::import::ImportOptions;
use footwork::physics::motion_list::{MotionList, MotionListOptions};

#[test]
fn a_list_gives_motions_with_weights_spans_kinds_and_mirrored_copies() {
    let folder = Folder::new();
    folder.bvh("walks/walk_01_slow.bvh", 121);
    folder.deepmimic("stand.txt", &vec![standing(1.0 / 30.0); 91]);
    let list = folder.text(
        "list.toml",
        r#"
[[clip]]
file = "walks/walk_01.bvh"
weight = 3.0
start = 1.0
end = 3.0
mirror = true
kind = "locomotion"

[[clip]]
file = "stand.txt"
"#,
    );
    let loaded = load(&list).expect("a list");
    let stem = "walk_01_slow";
    assert_eq!(names(&loaded), [stem, &format!("{stem} mirrored"), "stand"]);
    let library = &loaded.library;
    let kinds = [0, 1, 2].map(|motion| library.kind(motion));
    assert_eq!(kinds, ["locomotion", "locomotion", ""]);
    let frames: Vec<usize> = library
        .motions()
        .iter()
        .map(|motion| motion.frames)
        .collect();
    assert_eq!(frames, [61, 61, 91]);
    let shares = [0, 1, 2].map(|motion| library.share(motion));
    assert_eq!(shares, [0.375, 0.375, 0.25]);
    assert_eq!(library.sample([0.76, 0.0]).0, 2);
    let start = &library.motions()[0].q(0)[..2];
    assert_eq!(start, [0.0, 0.0]);

    let [walk, stand] = &loaded.report[..] else {
        panic!("two clips")
    };
    assert_eq!((&walk.name[..], &walk.kind[..]), (stem, "locomotion"));
    assert_eq!((walk.motions.clone(), stand.motions.clone()), (0..2, 2..3));
    assert_eq!((walk.seconds, stand.seconds), (2.0, 3.0));
    assert_eq!((walk.weight, walk.share, stand.share), (3.0, 0.75, 0.25));
    assert_eq!((walk.share_of_seconds, stand.share_of_seconds), (0.4, 0.6));
    assert_eq!(loaded.seconds(), 5.0);
    for clip in &loaded.report {
        let [low, high] = clip.foot_height;
        assert!(low.abs() < 0.02 && high < 0.1 && low <= high, "{clip:?}");
        assert!(clip.floor[0] > -0.02 && clip.floor[1] <= high, "{clip:?}");
        assert_eq!((clip.t_pose_frames, clip.grounded), (0, false));
    }
    assert_eq!(stand.limits_hit, 0.0);
}

#[test]
fn files_are_seen_from_the_folder_given_or_the_lists_own() {
    let folder = Folder::new();
    let file = folder.deepmimic("there/a.b.txt", &[standing(0.1), standing(0.1)]);
    let named =
        |name: &str| folder.text("here/list.toml", &format!("[[clip]]\nfile = \"{name}\"\n"));
    let list = named("../there/a.b.txt");
    assert!(MotionList::read(&list, None).is_ok());
    for name in ["a.b.txt", "a.txt", "a.b", "a"] {
        let list = named(name);
        assert!(MotionList::read(&list, None).is_err());
        let read = MotionList::read(&list, Some(&folder.path("there"))).expect("a list");
        assert_eq!(read.clips[0].file, file, "{name}");
    }
    // A whole name is not one of two that begin so.
    folder.deepmimic("there/a.b2.txt", &[standing(0.1), standing(0.1)]);
    let read = MotionList::read(&named("a.b"), Some(&folder.path("there"))).expect("a list");
    assert_eq!(read.clips[0].file, file);
}

#[test]
fn a_folder_is_a_list_of_equal_weights() {
    let folder = Folder::new();
    folder.bvh("motions/b.bvh", 121);
    folder.bvh("motions/short.bvh", 30);
    folder.bvh("motions/deeper/c.bvh", 121);
    folder.deepmimic("motions/a.txt", &vec![standing(1.0 / 30.0); 91]);
    folder.text("motions/LICENSE.txt", "Take it.");
    let manifest = "file,skip_head,skip_tail\nb.bvh,5,1\n";
    folder.text("motions/manifest.csv", manifest);
    let options = MotionListOptions {
        import: ImportOptions {
            mirror: true,
            ..ImportOptions::default()
        },
        min_frames: 61,
        ..MotionListOptions::default()
    };
    let loaded = load_with(&folder.path("motions"), &options).expect("a folder");
    assert_eq!(names(&loaded), ["a", "a mirrored", "b", "b mirrored"]);
    let [a, b] = &loaded.report[..] else {
        panic!("two clips")
    };
    assert_eq!((a.share, b.share, a.weight), (0.5, 0.5, 1.0));
    assert_eq!((a.t_pose_frames, b.t_pose_frames), (0, 6));
    assert_eq!(loaded.library.motions()[2].frames, 115);
    let notes = &loaded.library.notes;
    assert!(
        notes.iter().any(|note| note.contains("short (30)")),
        "{notes:?}"
    );

    let loaded = load(&folder.path("motions/a.txt")).expect("a file");
    assert_eq!(names(&loaded), ["a"]);
}

#[test]
fn joints_at_their_limits_are_counted() {
    let folder = Folder::new();
    let mut frames = vec![standing(1.0 / 30.0); 40];
    for frame in &mut frames[30..] {
        frame[super::RIGHT_KNEE] = -3.0;
    }
    let loaded = load(&folder.deepmimic("bent.txt", &frames)).expect("a file");
    assert_eq!(loaded.report[0].limits_hit, 0.25);
}

#[test]
fn feet_are_brought_to_the_ground_where_that_is_wanted() {
    let folder = Folder::new();
    folder.deepmimic("climb.txt", &climbing());
    folder.deepmimic("stand.txt", &vec![standing(1.0 / 30.0); 91]);
    let list = folder.text(
        "list.toml",
        "[[clip]]\nfile = \"climb.txt\"\nground = true\n",
    );
    let options = MotionListOptions {
        ground: true,
        ..MotionListOptions::default()
    };
    let listed = load(&list).expect("ground = true");
    let chosen = load_with(folder.0.path(), &options).expect("the option");
    let grounded: Vec<bool> = chosen.report.iter().map(|clip| clip.grounded).collect();
    assert_eq!(grounded, [true, false]);
    for clip in [&listed.report[0], &chosen.report[0]] {
        assert!(clip.grounded);
        assert!(
            clip.floor[0].abs() < 0.02 && clip.floor[1].abs() < 0.02,
            "{clip:?}"
        );
    }
    assert_eq!(listed.library.motions()[0], chosen.library.motions()[0]);
    let step = &listed.library.motions()[0];
    let rise = step.q(179)[2] - step.q(0)[2];
    assert!(rise.abs() < 1e-3, "{rise}");
}
