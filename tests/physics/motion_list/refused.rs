//! What lists cannot be used, and what is said of them.

use super::{Folder, climbing, load, load_with, standing};
use footwork::motion::bvh;
use footwork::physics::humanoid::punching_box;
use footwork::physics::motion_list::{MotionList, MotionListOptions};
use std::sync::Arc;

/// A folder with recordings, and why a list in it is refused.
struct Lists(Folder);

impl Lists {
    fn new() -> Lists {
        let folder = Folder::new();
        folder.deepmimic("stand.txt", &vec![standing(1.0 / 30.0); 91]);
        folder.deepmimic("walk_1.txt", &vec![standing(1.0 / 30.0); 91]);
        folder.deepmimic("walk_2.txt", &vec![standing(1.0 / 30.0); 91]);
        folder.deepmimic("climb.txt", &climbing());
        Lists(folder)
    }

    /// The error contains all these.
    fn refused(&self, list: &str, parts: &[&str]) {
        let path = self.0.text("list.toml", list);
        let error = load(&path).expect_err(list).to_string();
        for part in parts.iter().chain(&["list.toml"]) {
            assert!(error.contains(part), "'{part}' is not in: {error}");
        }
        assert!(!error.contains('\n'), "{error}");
    }
}

#[test]
fn mistakes_in_a_list_are_said_with_their_line() {
    let lists = Lists::new();
    lists.refused("", &["names no clip", "[[clip]]"]);
    lists.refused("# nothing\nclip = []\n", &["names no clip"]);
    lists.refused("[[clip]]\nfile = \"stand.txt\n", &["line 2"]);
    let unknown = "[[clip]]\nfile = \"stand.txt\"\nstrat = 1.0\n";
    lists.refused(unknown, &["line 3", "`strat`", "`start`"]);
    lists.refused("clips = 3\n", &["line 1", "`clips`", "`clip`"]);
    lists.refused(
        "\n[[clip]]\nweight = 2.0\n",
        &["line 2", "missing field `file`"],
    );
    let text = "[[clip]]\nfile = \"stand.txt\"\nweight = \"much\"\n";
    lists.refused(text, &["line 3", "invalid type"]);
    for weight in ["0.0", "-1.0", "nan", "inf"] {
        let list = format!("# boxing\n\n[[clip]]\nfile = \"stand.txt\"\nweight = {weight}\n");
        lists.refused(&list, &["line 4", "the weight is", "above zero"]);
    }
}

#[test]
fn files_that_are_not_there_are_said_with_the_folder_searched() {
    let lists = Lists::new();
    let folder = lists.0.path("").display().to_string();
    let folder = folder.trim_end_matches('/');
    lists.refused(
        "[[clip]]\nfile = \"run.txt\"\n",
        &["line 2", "'run.txt'", folder],
    );
    lists.refused(
        "[[clip]]\nfile = \"stand.bvh\"\n",
        &["line 2", "'stand.bvh'"],
    );
    lists.refused(
        "[[clip]]\nfile = \"cmu/run.bvh\"\n",
        &["'cmu/run.bvh'", "cmu cannot be read"],
    );
    let two = ["'walk.txt'", "walk_1.txt, walk_2.txt", folder];
    lists.refused("[[clip]]\nfile = \"walk.txt\"\n", &two);
    let missing = load(&lists.0.path("missing.toml"))
        .expect_err("refused")
        .to_string();
    assert!(missing.contains("cannot read") && missing.contains("missing.toml"));
    let missing = load(&lists.0.path("missing.bvh"))
        .expect_err("refused")
        .to_string();
    assert!(
        missing.contains("cannot read") && missing.contains("missing.bvh"),
        "{missing}"
    );
}

#[test]
fn spans_lie_within_their_clips() {
    let lists = Lists::new();
    for span in [
        "start = 1.0\nend = 3.1",
        "start = 3.5",
        "start = 2.0\nend = 1.0",
        "start = -1.0",
        "end = nan",
    ] {
        let list = format!("[[clip]]\nfile = \"stand.txt\"\n{span}\n");
        lists.refused(&list, &["line 2", "'stand'", "lasts 3.00 s"]);
    }
    // One frame is no motion.
    let list = "[[clip]]\nfile = \"stand.txt\"\nend = 0.01\n";
    lists.refused(list, &["line 2", "'stand' has 1 frames", "2 are needed"]);
}

#[test]
fn clips_are_as_long_as_their_user_needs() {
    let lists = Lists::new();
    let list = lists
        .0
        .text("list.toml", "[[clip]]\nfile = \"stand.txt\"\n");
    let options = MotionListOptions {
        min_frames: 92,
        ..MotionListOptions::default()
    };
    let error = load_with(&list, &options).expect_err("refused").to_string();
    assert!(
        error.contains("'stand' has 91 frames") && error.contains("92 are needed"),
        "{error}"
    );
    let folder = Folder::new();
    folder.bvh("a.bvh", 40);
    let error = load_with(folder.0.path(), &options)
        .expect_err("refused")
        .to_string();
    assert!(
        error.contains("long enough") && error.contains("92 frames"),
        "{error}"
    );
    folder.bvh("deep/a.bvh", 100);
    std::fs::remove_file(folder.path("a.bvh")).expect("removed");
    let error = load(folder.0.path()).expect_err("refused").to_string();
    assert!(
        error.contains("no recording in") && error.contains("sub-folders"),
        "{error}"
    );
}

#[test]
fn feet_in_the_air_are_refused_with_their_heights() {
    let lists = Lists::new();
    let parts = ["line 2", "'climb'", "0.00 to 0.40 m", "`ground = true`"];
    lists.refused("[[clip]]\nfile = \"climb.txt\"\n", &parts);
    let list = lists.0.text(
        "list.toml",
        "[[clip]]\nfile = \"climb.txt\"\nground = false\n",
    );
    let options = MotionListOptions {
        ground: true,
        ..MotionListOptions::default()
    };
    assert!(load_with(&list, &options).is_err());
}

#[test]
fn bodies_that_do_not_fit_are_refused() {
    let lists = Lists::new();
    let path = lists.0.bvh("limbs.bvh", 61);
    let mut clip = bvh::read(&path)
        .expect("a recording")
        .into_clip("limbs", 1.0, 0..61);
    for end in &mut clip.skeleton.ends {
        end.1 = glam::Vec3::ZERO;
    }
    let short = |name: &String| name.contains("Fore") || name.contains("Hand");
    for joint in 0..clip.skeleton.joints() {
        if short(&clip.skeleton.names[joint]) {
            clip.skeleton.offsets[joint] *= 1e-3;
        }
    }
    bvh::write(&path, &clip).expect("written");
    lists.refused(
        "[[clip]]\nfile = \"limbs.bvh\"\n",
        &["line 2", "'limbs'", "there is no elbow"],
    );
    let list = lists
        .0
        .text("list.toml", "[[clip]]\nfile = \"stand.txt\"\n");
    let list = MotionList::read(&list, None).expect("a list");
    let error = list.load(&Arc::new(punching_box()), &MotionListOptions::default());
    let error = error.expect_err("refused").to_string();
    assert!(error.contains("'pelvis'"), "{error}");
}
