//! `trajectories`: a panel of walks for every stage.

use super::drawn;
use footwork::report::trajectories::{self, Group};

fn walk(colour: usize, reached: bool) -> trajectories::Path {
    trajectories::Path {
        points: (0..60)
            .map(|frame| frame as f32 / 20.0)
            .map(|time| [time, time.sin()])
            .collect(),
        target: [3.4, 0.2],
        reached,
        label: "2.0 s".to_owned(),
        colour,
    }
}

#[test]
fn every_stage_has_its_panel_of_paths() {
    let groups: Vec<Group> = (0..4)
        .map(|stage| Group {
            title: format!("stage {stage}"),
            paths: vec![walk(stage, stage > 0)],
        })
        .collect();
    let picture = drawn(|path| trajectories::draw(path, &groups));
    assert_eq!((picture.width, picture.height), (1978, 572));
    for panel in 0..4 {
        let left = 0.06 + 0.236 * f64::from(panel);
        assert!(picture.colours((left, left + 0.22), (0.12, 0.85)) > 30);
    }
    for colour in [[0x00, 0x72, 0xb2], [0xd5, 0x5e, 0x00]] {
        assert!(picture.has(colour));
    }
}

#[test]
fn paths_survive_whatever_they_are_given() {
    let nowhere = trajectories::Path {
        points: vec![[f32::NAN, 0.0], [f32::INFINITY, 1.0]],
        target: [f32::NAN; 2],
        ..walk(0, true)
    };
    let standing = trajectories::Path {
        points: vec![[1.0, 1.0]; 20],
        target: [1.0, 1.0],
        ..walk(1, false)
    };
    let far = trajectories::Path {
        points: vec![[0.0, 0.0], [1e30, -1e30]],
        ..walk(2, false)
    };
    let cases = [
        vec![],
        vec![trajectories::Path::default()],
        vec![nowhere],
        vec![standing],
        vec![far],
    ];
    let groups = cases.map(|paths| Group {
        title: String::new(),
        paths,
    });
    for group in &groups {
        drawn(|path| trajectories::draw(path, std::slice::from_ref(group)));
    }
    drawn(|path| trajectories::draw(path, &[]));
    let picture = drawn(|path| trajectories::draw(path, &groups));
    assert_eq!(picture.height, 2 * 572, "five panels take two rows");
}
