//! Real recordings, where there are some: all of them, of seven skeletons.

use super::{Bodies, LEG, UPRIGHT, max_speed, percentile};
use crate::mocap::recordings;
use footwork::motion::bvh;
use footwork::motion::import::{ImportOptions, import};
use footwork::motion::roles::Roles;
use footwork::motion::units;
use footwork::physics::humanoid::humanoid;
use footwork::physics::motion_library::MotionLibrary;
use footwork::physics::retarget::retarget;
use glam::Vec3;
use std::sync::Arc;

/// Folders, and how far their ankles and wrists may be from where they were recorded, as seen from hips
/// and shoulders, in 95 % of frames, cm: bones of other proportions than the humanoid's lead elsewhere.
const FOLDERS: [(&str, f32, f32); 7] = [
    ("pfnn15", 1.5, 2.0),
    ("boxing/snu15", 1.5, 2.0),
    ("boxing/mb31", 1.0, 8.0),
    ("boxing/daz43_karate", 8.5, 3.5),
    ("cmu/mb31", 2.5, 5.0),
    ("cmu/daz43", 6.5, 2.5),
    ("lafan1", 1.5, 5.0),
];

/// From the humanoid's shoulder to its hand, m.
const ARM: f32 = 0.533735;

/// A joint may turn no faster, rad/s. Punches turn elbows by 26 a second.
const FASTEST: f32 = 30.0;

/// Recordings that begin with one.
const T_POSES: [&str; 3] = [
    "cmu/mb31/02_01.bvh",
    "boxing/daz43_karate/135_03.bvh",
    "boxing/mb31/02_05.bvh",
];

#[test]
fn real_recordings_move_the_humanoid() {
    let Some(mocap) = recordings("") else { return };
    let model = Arc::new(humanoid());
    for (folder, ankles, wrists) in FOLDERS {
        let import = import(&mocap.join(folder), &ImportOptions::default()).expect("recordings");
        let roles = import.roles;
        let library = MotionLibrary::of(&import.clips, &roles, &model).expect("people");
        let (mut ankle, mut wrist, mut speed) = (Vec::new(), Vec::new(), 0.0f32);
        for (clip, motion) in import.clips.iter().zip(library.motions()) {
            let skeleton = &clip.skeleton;
            let below = |joint| {
                skeleton
                    .parents
                    .iter()
                    .position(|&parent| parent == Some(joint))
            };
            let wrist_of = |shoulder| below(below(shoulder)?);
            let [left, right] = [roles.left_shoulder, roles.right_shoulder]
                .map(|shoulder| wrist_of(shoulder).expect("a wrist"));
            let leg = LEG / units::leg(skeleton, &roles);
            let arm = ARM / skeleton.reach(roles.left_shoulder, left);
            let mut low = Vec::new();
            for frame in 0..motion.frames {
                let bodies = Bodies::of(&model, motion.q(frame));
                let (at, _) = clip.world(frame);
                let off = |from: usize, to: usize, scale: f32, names: [&str; 2]| {
                    let recorded = UPRIGHT * (at[to] - at[from]) * scale;
                    let [from, to] = names.map(|name| bodies.position(name));
                    recorded.distance(to - from)
                };
                let legs = [["left_thigh", "left_foot"], ["right_thigh", "right_foot"]];
                let arms = [
                    ["left_upper_arm", "left_hand"],
                    ["right_upper_arm", "right_hand"],
                ];
                ankle.push(off(roles.left_hip, roles.left_foot, leg, legs[0]));
                ankle.push(off(roles.right_hip, roles.right_foot, leg, legs[1]));
                wrist.push(off(roles.left_shoulder, left, arm, arms[0]));
                wrist.push(off(roles.right_shoulder, right, arm, arms[1]));
                low.push(bodies.lowest());
            }
            let (low, name) = (percentile(&mut low, 0.01), &motion.name);
            assert!(
                low > -0.01,
                "{folder}, {name}: feet {low} m below the ground"
            );
            let start = Vec3::from_slice(motion.q(0));
            assert!(
                start.truncate().length() < 0.2,
                "{folder}, {name}: begins at {start}"
            );
            speed = speed.max(max_speed(&model, motion));
        }
        let of = |off: &mut [f32], share| 100.0 * percentile(off, share);
        println!(
            "{folder}: ankles off by {:.1} cm (95 %: {:.1}), wrists by {:.1} (95 %: {:.1}), joints rotation at most {speed:.1} rad/s",
            of(&mut ankle, 0.5),
            of(&mut ankle, 0.95),
            of(&mut wrist, 0.5),
            of(&mut wrist, 0.95)
        );
        assert!(of(&mut ankle, 0.95) < ankles, "{folder}");
        assert!(of(&mut wrist, 0.95) < wrists, "{folder}");
        assert!(speed < FASTEST, "{folder}: {speed}");
    }
}

#[test]
fn real_t_poses_have_horizontal_arms() {
    let Some(mocap) = recordings("") else { return };
    let model = humanoid();
    for file in T_POSES {
        let recording = bvh::read(&mocap.join(file)).expect("a recording");
        let roles = Roles::find(&recording.skeleton).expect("a person");
        let mut clip = recording.into_clip(file, 0.01, 0..1);
        // Two frames are the least that move.
        clip.positions.push(clip.positions[0]);
        clip.rotations.extend_from_within(..);
        clip.rate = 30.0;
        let motion = retarget(&clip, &roles, &model).expect("a person");
        let bodies = Bodies::of(&model, motion.q(0));
        let across = bodies.position("left_hand") - bodies.position("right_hand");
        for side in ["left", "right"] {
            let position = |part: &str| bodies.position(&format!("{side}_{part}"));
            let arm = position("hand") - position("upper_arm");
            let fall = (arm.z / arm.length()).asin().to_degrees();
            println!("{file}, {side}: {fall:.1} degrees above level");
            assert!(fall.abs() < 12.0, "{file}, {side}: {fall}");
            assert!(arm.length() > 0.98 * ARM, "{file}, {side}: bent");
            assert!(
                across.normalize().dot(arm.normalize()).abs() > 0.95,
                "{file}, {side}: {arm}"
            );
        }
    }
}
