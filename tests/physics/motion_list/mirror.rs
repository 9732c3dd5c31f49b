//! Motions with left and right exchanged.

use super::{Folder, RIGHT_KNEE, standing};
use crate::mocap::recordings;
use crate::retarget::{Bodies, performed};
use footwork::physics::deepmimic::read;
use footwork::physics::humanoid::{BODIES, humanoid};
use footwork::physics::mirror::mirrored;
use footwork::physics::motion_clip::MotionClip;
use footwork::physics::retarget::retarget;
use footwork::physics::scenes::boxing_match;
use glam::{Quat, Vec3};

fn other_side(body: &str) -> String {
    match body.strip_prefix("left_") {
        Some(part) => format!("right_{part}"),
        None => body.replace("right_", "left_"),
    }
}

fn check(clip: &MotionClip) {
    let model = humanoid();
    let mirror = mirrored(&model, clip).expect("a humanoid");
    assert_eq!(&mirrored(&model, &mirror).expect("a humanoid"), clip);
    for frame in (0..clip.frames).step_by(7) {
        let own = Bodies::of(&model, clip.q(frame));
        let other = Bodies::of(&model, mirror.q(frame));
        for body in BODIES {
            let (a, b) = (own.pose(body), other.pose(&other_side(body)));
            let position = a.position * Vec3::new(1.0, -1.0, 1.0);
            assert!(position.distance(b.position) < 1e-5, "{body}, {frame}");
            let [x, y, z, w] = a.rotation.to_array();
            let rotation = Quat::from_xyzw(-x, y, -z, w);
            assert!(
                rotation.dot(b.rotation).abs() > 1.0 - 1e-5,
                "{body}, {frame}"
            );
        }
    }
    // Velocities are those that the mirrored positions have.
    let again = MotionClip::new(&mirror.name, &model, mirror.rate, mirror.q.clone());
    let off = again.v.iter().zip(&mirror.v).map(|(a, b)| (a - b).abs());
    assert!(off.fold(0.0, f32::max) < 1e-3);
}

#[test]
fn mirrored_motion_is_reflected_and_twice_mirrored_the_same() {
    let (clip, roles) = performed();
    check(&retarget(&clip, &roles, &humanoid()).expect("a person"));
    let folder = Folder::new();
    let mut frames = vec![standing(0.1); 3];
    frames[1][RIGHT_KNEE] = -1.0;
    frames[1][21] = 0.8;
    frames[1][22] = 0.6;
    check(&read(&folder.deepmimic("a.txt", &frames), &humanoid()).expect("a clip"));
}

#[test]
fn real_motion_is_reflected() {
    let Some(file) = recordings("humanoid/deepmimic/data/motions/humanoid3d_spinkick.txt") else {
        return;
    };
    check(&read(&file, &humanoid()).expect("a clip"));
}

#[test]
fn a_model_of_one_side_is_not_mirrored() {
    let model = humanoid();
    let clip = MotionClip::new("rest", &model, 30.0, [&model.qpos0[..]; 2].concat());
    let mut other = model.clone();
    let hand = other.body("left_shin").expect("a shin");
    other.bodies[hand].name = "left_peg".to_string();
    let error = mirrored(&other, &clip).expect_err("refused").to_string();
    assert!(
        error.contains("'right_shin'") && error.contains("'left_shin'"),
        "{error}"
    );
    let both = boxing_match();
    let clip = MotionClip::new("rest", &both, 30.0, [&both.qpos0[..]; 2].concat());
    assert!(mirrored(&both, &clip).is_ok());
}
