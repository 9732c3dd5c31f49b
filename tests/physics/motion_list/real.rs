//! The lists of `examples/`, where there are their recordings.

use crate::mocap::recordings;
use footwork::physics::humanoid::humanoid;
use footwork::physics::motion_list::{MotionList, MotionListOptions};
use std::path::Path;
use std::sync::Arc;

/// Lists, how many clips they name, and how long these are, s.
const LISTS: [(&str, usize, f32); 3] = [
    ("L17", 17, 248.47),
    ("B5", 5, 74.11),
    ("L17_B5", 22, 322.58),
];

#[test]
fn the_lists_of_the_examples_load() {
    let Some(mocap) = recordings("") else { return };
    let model = Arc::new(humanoid());
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    for (name, clips, seconds) in LISTS {
        let list = examples.join(format!("{name}.toml"));
        let list = MotionList::read(&list, Some(&mocap)).expect(name);
        let options = MotionListOptions {
            min_frames: 61,
            ..MotionListOptions::default()
        };
        let loaded = list.load(&model, &options).expect(name);
        println!(
            "{name}: {:.2} s; {:?}",
            loaded.seconds(),
            loaded.library.notes
        );
        for clip in &loaded.report {
            println!(
                "{:35} {:10} {:6.2} s  weight {:.1}  share {:.4}  of seconds {:.4}  feet {:6.3} {:6.3}  floor {:6.3} {:6.3}  limits {:.3}  T {:3}",
                clip.name,
                clip.kind,
                clip.seconds,
                clip.weight,
                clip.share,
                clip.share_of_seconds,
                clip.foot_height[0],
                clip.foot_height[1],
                clip.floor[0],
                clip.floor[1],
                clip.limits_hit,
                clip.t_pose_frames,
            );
        }
        assert_eq!(loaded.report.len(), clips);
        assert!(
            (loaded.seconds() - seconds).abs() < 0.5,
            "{name}: {} s",
            loaded.seconds()
        );
        assert!(loaded.report.iter().all(|clip| !clip.kind.is_empty()));
        if name == "L17_B5" {
            let boxing = loaded.report.iter().filter(|clip| clip.kind == "boxing");
            let share: f32 = boxing.map(|clip| clip.share).sum();
            assert!((share - 0.5).abs() < 1e-3, "{share}");
        }
    }
}

#[test]
fn recordings_on_a_sloping_floor_are_refused_or_grounded() {
    let Some(folder) = recordings("cmu/mb31") else {
        return;
    };
    let model = Arc::new(humanoid());
    let list = MotionList::read(&folder, None).expect("a folder");
    let mut options = MotionListOptions::default();
    let error = list
        .load(&model, &options)
        .expect_err("refused")
        .to_string();
    assert!(
        error.contains("07_05.bvh") && error.contains("0.11 m"),
        "{error}"
    );
    options.ground = true;
    let loaded = list.load(&model, &options).expect("grounded");
    let grounded = loaded.report.iter().filter(|clip| clip.grounded);
    let grounded: Vec<_> = grounded.collect();
    assert_eq!(grounded.len(), 1);
    assert_eq!(grounded[0].name, "07_05");
    assert!(grounded[0].floor[1] < 0.02, "{:?}", grounded[0]);
}
