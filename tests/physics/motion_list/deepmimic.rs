//! DeepMimic's recordings in the humanoid.

use super::{
    Folder, LEFT_ELBOW, LEFT_KNEE, RIGHT_ELBOW, RIGHT_KNEE, ROOT, ROOT_ROTATION, joint, standing,
};
use crate::mocap::recordings;
use crate::retarget::Bodies;
use footwork::physics::deepmimic::read;
use footwork::physics::humanoid::{humanoid, punching_box};
use glam::Vec3;
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2};
use std::path::Path;

fn refused(frames: &[Vec<f64>]) -> String {
    let folder = Folder::new();
    let path = folder.deepmimic("clip.txt", frames);
    read(&path, &humanoid()).expect_err("refused").to_string()
}

#[test]
fn axes_and_bends_are_the_humanoids() {
    let folder = Folder::new();
    let model = humanoid();
    let mut frames = vec![standing(0.1), standing(0.1)];
    let last = &mut frames[1];
    for elbow in [RIGHT_ELBOW, LEFT_ELBOW] {
        last[elbow] = FRAC_PI_2;
    }
    for knee in [RIGHT_KNEE, LEFT_KNEE] {
        last[knee] = -FRAC_PI_2;
    }
    last[ROOT] = 0.5;
    last[ROOT + 2] = 0.25;
    let clip = read(&folder.deepmimic("bends.txt", &frames), &model).expect("a clip");
    assert_eq!(
        (clip.name.as_str(), clip.rate, clip.frames),
        ("bends", 30.0, 4)
    );
    let bodies = Bodies::of(&model, clip.q(3));
    let near = |a: Vec3, b: Vec3| assert!(a.distance(b) < 1e-3, "{a} is not {b}");
    let root = bodies.position("pelvis");
    near(root.with_z(0.0), Vec3::new(0.5, -0.25, 0.0));
    for side in ["right", "left"] {
        let position = |part: &str| bodies.position(&format!("{side}_{part}"));
        near(position("hand") - position("lower_arm"), Vec3::X * 0.258947);
        near(position("foot") - position("shin"), Vec3::NEG_X * 0.40987);
    }
    assert!(bodies.position("right_hand").y < bodies.position("left_hand").y);

    // A quarter turn to the left about the vertical.
    let mut frames = vec![standing(0.1); 2];
    for frame in &mut frames {
        frame[ROOT_ROTATION..][..4].copy_from_slice(&[FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2, 0.0]);
    }
    let clip = read(&folder.deepmimic("turned.txt", &frames), &model).expect("a clip");
    near(
        Bodies::of(&model, clip.q(0)).pose("pelvis").rotation * Vec3::X,
        Vec3::Y,
    );
}

#[test]
fn uneven_durations_are_resampled_evenly() {
    let folder = Folder::new();
    let model = humanoid();
    let durations = [0.1, 0.02, 0.005, 0.375, 0.5, 0.0];
    let mut time = 0.0;
    let frames = durations.map(|duration| {
        let mut frame = standing(duration);
        frame[ROOT] = time;
        frame[RIGHT_KNEE] = -time;
        time += duration;
        frame
    });
    let clip = read(&folder.deepmimic("even.txt", &frames), &model).expect("a clip");
    assert_eq!(clip.frames, 31);
    let knee = joint(&model, "right_knee");
    for frame in 0..clip.frames {
        let time = frame as f32 / 30.0;
        let q = clip.q(frame);
        assert!((q[0] - time).abs() < 1e-5 && (q[knee] - time).abs() < 1e-5);
    }
    assert!((clip.v(10)[0] - 1.0).abs() < 1e-3);
}

#[test]
fn joints_stay_in_their_ranges_and_quaternions_need_no_unit_length() {
    let folder = Folder::new();
    let model = humanoid();
    let mut frames = vec![standing(0.1); 2];
    for frame in &mut frames {
        frame[RIGHT_KNEE] = 0.3;
        frame[LEFT_ELBOW] = 3.1;
        frame[ROOT_ROTATION] = 0.6;
    }
    let clip = read(&folder.deepmimic("far.txt", &frames), &model).expect("a clip");
    let q = clip.q(0);
    assert_eq!(q[joint(&model, "right_knee")], 0.0);
    assert!((q[joint(&model, "left_elbow")] + 160f32.to_radians()).abs() < 1e-5);
    assert_eq!(q[3..7], [1.0, 0.0, 0.0, 0.0]);
}

#[test]
fn damaged_files_are_refused_with_file_and_frame() {
    let folder = Folder::new();
    let model = humanoid();
    let read = |path: &Path| read(path, &model).expect_err("refused").to_string();
    let missing = read(&folder.path("missing.txt"));
    assert!(missing.contains("missing.txt"), "{missing}");
    let cut = folder.text("cut.txt", "{\n\"Loop\": \"wrap\",\n\"Frames\": [[0.1, 0.5");
    let cut = read(&cut);
    assert!(cut.contains("cut.txt") && cut.contains("line 3"), "{cut}");
    let other = read(&folder.text("other.txt", "{\"frames\": []}"));
    assert!(other.contains("missing field `Frames`"), "{other}");

    for frames in [vec![], vec![standing(0.1)], vec![standing(0.01); 2]] {
        let error = refused(&frames);
        assert!(error.contains("at least two frames"), "{error}");
    }
    let good = standing(0.1);
    let changed = |number: usize, value: f64| {
        let mut frame = standing(0.1);
        frame[number] = value;
        vec![good.clone(), frame, good.clone()]
    };
    let short = vec![good.clone(), good[..43].to_vec()];
    for (frames, problem) in [
        (short, "it has 43 numbers, not 44"),
        (changed(7, 1e300), "its number 8 is"),
        (changed(0, 0.0), "it lasts 0 s"),
        (changed(0, -1.0), "it lasts -1 s"),
        (changed(0, 1e6), "it lasts 1000000 s"),
        (
            changed(9, 1e30),
            "the rotation of its torso is no quaternion",
        ),
        (
            changed(8, 0.0),
            "the rotation of its torso is no quaternion",
        ),
    ] {
        let error = refused(&frames);
        assert!(error.contains("clip.txt, frame 2: "), "{error}");
        assert!(error.contains(problem), "{error}");
    }
    let path = folder.deepmimic("box.txt", &vec![good; 2]);
    let error = footwork::physics::deepmimic::read(&path, &punching_box()).expect_err("refused");
    assert!(error.to_string().contains("pelvis"), "{error}");
}

#[test]
fn a_walk_looks_like_one() {
    let Some(folder) = recordings("humanoid/deepmimic/data/motions") else {
        return;
    };
    let model = humanoid();
    for name in [
        "humanoid3d_walk",
        "humanoid3d_run",
        "long/humanoid3d_long_walk2",
    ] {
        let clip = read(&folder.join(format!("{name}.txt")), &model).expect("a clip");
        let (mut ahead, mut bends, mut swapped, mut first) = (0.0f32, 0, 0, None);
        for frame in 0..clip.frames {
            let bodies = Bodies::of(&model, clip.q(frame));
            let facing = bodies.pose("pelvis").rotation * Vec3::X;
            let facing = facing.with_z(0.0).normalize();
            assert!(
                bodies.position("head").z > 1.2,
                "{name}, {frame}: head down"
            );
            assert!(bodies.lowest() < 0.2, "{name}, {frame}: in the air");
            ahead += facing.dot(Vec3::from_slice(clip.v(frame))) / clip.rate;
            let [right, left] = ["right", "left"].map(|side| {
                let position = |part: &str| bodies.position(&format!("{side}_{part}"));
                let middle = (position("thigh") + position("foot")) / 2.0;
                bends += usize::from(facing.dot(position("shin") - middle) > 0.0);
                position("foot").z
            });
            // Whenever one foot is clearly higher, is it the other than before?
            if (right - left).abs() > 0.05 {
                let now = right > left;
                swapped += usize::from(first.is_some_and(|before| before != now));
                first = Some(now);
            }
        }
        let speed = ahead / clip.seconds();
        println!(
            "{name}: {speed:.2} m/s, {swapped} swaps in {:.1} s",
            clip.seconds()
        );
        assert!(speed > 0.5, "{name}: {speed} m/s forwards");
        assert!(
            bends > 2 * clip.frames * 9 / 10,
            "{name}: knees bend backwards"
        );
        assert!(
            (swapped + 1) as f32 >= 1.4 * clip.seconds(),
            "{name}: {swapped} steps"
        );
    }
}
