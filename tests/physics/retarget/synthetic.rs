//! What holds for any recording, seen in one that nobody made.

use super::{Bodies, LEG, UPRIGHT, humanoid_and, max_speed, percentile, performed};
use footwork::motion::clip::Clip;
use footwork::motion::mirror::mirror;
use footwork::motion::units;
use footwork::physics::drive::rotation_vector;
use footwork::physics::humanoid::{humanoid, punching_box};
use footwork::physics::integrate::drift;
use footwork::physics::kinematics::quaternion;
use footwork::physics::model::{JointKind, Model};
use footwork::physics::motion_clip::pd_targets;
use footwork::physics::retarget::{RetargetError, retarget};
use glam::{Quat, Vec3};

/// Two frames of the performer's skeleton in a T-pose.
fn t_pose() -> Clip {
    let (mut clip, _) = performed();
    clip.positions.truncate(2);
    clip.positions.fill(Vec3::Y);
    clip.rotations = vec![Quat::IDENTITY; 2 * clip.skeleton.joints()];
    clip
}

/// The same motion of a skeleton whose joints' axes lie otherwise: whole axes in the trunk, any in limbs.
fn other_axes(clip: &Clip) -> Clip {
    let mut clip = clip.clone();
    let skeleton = &mut clip.skeleton;
    let trunk = ["Hips", "Spine", "Spine1", "Spine2", "Neck", "Head"];
    let own: Vec<Quat> = skeleton
        .names
        .iter()
        .enumerate()
        .map(|(joint, name)| match trunk.contains(&name.as_str()) {
            true => UPRIGHT,
            false => Quat::from_scaled_axis(Vec3::new(0.3, -1.1, 0.7) * (joint as f32 - 5.5)),
        })
        .collect();
    let of = |joint: Option<usize>| joint.map_or(Quat::IDENTITY, |joint| own[joint]);
    let joints = skeleton.joints();
    for joint in 0..joints {
        let parent = of(skeleton.parents[joint]);
        skeleton.offsets[joint] = parent.inverse() * skeleton.offsets[joint];
        for pose in clip.rotations.chunks_exact_mut(joints) {
            pose[joint] = parent.inverse() * pose[joint] * own[joint];
        }
    }
    for (joint, end) in &mut skeleton.ends {
        *end = own[*joint].inverse() * *end;
    }
    clip
}

#[test]
fn a_t_pose_has_straight_horizontal_arms_and_straight_legs() {
    let (_, roles) = performed();
    for clip in [t_pose(), other_axes(&t_pose())] {
        let (model, motion) = humanoid_and(&clip, &roles);
        let bodies = Bodies::of(&model, motion.q(0));
        for (side, out) in [("left", Vec3::Y), ("right", Vec3::NEG_Y)] {
            let at = |part: &str| bodies.position(&format!("{side}_{part}"));
            let arm = at("hand") - at("upper_arm");
            let leg = at("foot") - at("thigh");
            assert!(arm.angle_between(out) < 2e-3, "{side}: {arm}");
            assert!((arm.length() - 0.5337).abs() < 1e-3, "{side}: {arm}");
            assert!(leg.angle_between(Vec3::NEG_Z) < 2e-3, "{side}: {leg}");
            let sole = bodies.pose(&format!("{side}_foot")).rotation;
            assert!((sole * Vec3::Z).angle_between(Vec3::Z) < 2e-3);
            assert!((sole * Vec3::X).angle_between(Vec3::X) < 2e-3);
        }
        assert!(bodies.lowest().abs() < 1e-4);
        assert!(motion.v.iter().all(|v| v.abs() < 1e-3));
    }
}

#[test]
fn joints_axes_make_no_difference() {
    let (clip, roles) = performed();
    let (model, one) = humanoid_and(&clip, &roles);
    let (_, other) = humanoid_and(&other_axes(&clip), &roles);
    for frame in 0..one.frames {
        let [one, other] = [&one, &other].map(|motion| Bodies::of(&model, motion.q(frame)));
        for (a, b) in one.poses.iter().zip(&other.poses) {
            assert!(
                a.position.distance(b.position) < 2e-3,
                "{frame}: {a:?} {b:?}"
            );
            assert!(
                a.rotation.dot(b.rotation).abs() > 1.0 - 1e-4,
                "{frame}: {a:?} {b:?}"
            );
        }
    }
}

#[test]
fn limbs_go_where_the_performers_go_and_feet_stand_on_the_ground() {
    let (clip, roles) = performed();
    let (model, motion) = humanoid_and(&clip, &roles);
    let scale = LEG / units::leg(&clip.skeleton, &roles);
    let (mut off, mut low) = (Vec::new(), Vec::new());
    for frame in 0..motion.frames {
        let bodies = Bodies::of(&model, motion.q(frame));
        let (at, _) = clip.world(frame);
        for (side, hip, foot) in [
            ("left", roles.left_hip, roles.left_foot),
            ("right", roles.right_hip, roles.right_foot),
        ] {
            let leg = UPRIGHT * (at[foot] - at[hip]) * scale;
            let position = |part: &str| bodies.position(&format!("{side}_{part}"));
            off.push((position("foot") - position("thigh")).distance(leg));
        }
        low.push(bodies.lowest());
    }
    let (off, low) = (percentile(&mut off, 1.0), percentile(&mut low, 0.01));
    let max_speed = max_speed(&model, &motion);
    println!(
        "ankles are at most {:.1} cm off; 99 % of frames are above {:.1} cm; joints rotation at most {max_speed:.1} rad/s",
        100.0 * off,
        100.0 * low
    );
    assert!(off < 0.02, "{off}");
    assert!(low.abs() < 1e-3, "{low}");
    assert!(max_speed < 20.0, "{max_speed}");
}

#[test]
fn a_mirrored_clip_gives_a_mirrored_body() {
    let (clip, roles) = performed();
    let (model, motion) = humanoid_and(&clip, &roles);
    let (_, seen) = humanoid_and(&mirror(&clip).expect("a symmetric skeleton"), &roles);
    for frame in 0..motion.frames {
        let [bodies, seen] = [&motion, &seen].map(|motion| Bodies::of(&model, motion.q(frame)));
        for body in &model.bodies {
            let other = match body.name.split_once('_') {
                Some(("left", part)) => format!("right_{part}"),
                Some(("right", part)) => format!("left_{part}"),
                _ => body.name.clone(),
            };
            let (one, other) = (bodies.pose(&body.name), seen.pose(&other));
            let position = other.position * Vec3::new(1.0, -1.0, 1.0);
            let rotation = Quat::from_xyzw(
                -other.rotation.x,
                other.rotation.y,
                -other.rotation.z,
                other.rotation.w,
            );
            assert!(
                one.position.distance(position) < 1e-3,
                "{frame}, {}",
                body.name
            );
            assert!(
                one.rotation.dot(rotation).abs() > 1.0 - 1e-5,
                "{frame}, {}",
                body.name
            );
        }
    }
}

#[test]
fn velocities_lead_from_frame_to_frame() {
    let (clip, roles) = performed();
    let (model, motion) = humanoid_and(&clip, &roles);
    let last = motion.frames - 1;
    let (mut worst, mut ahead) = (0.0f32, Vec::new());
    for frame in 0..=last {
        let (before, after) = (frame.saturating_sub(1), (frame + 1).min(last));
        let mut q = motion.q(before).to_vec();
        let dt = (after - before) as f32 / motion.rate;
        drift(&model, motion.v(frame), dt, &mut q);
        worst = worst.max(apart(&model, &q, motion.q(after)));
        // The mean of two frames' velocities leads from the one to the other, unless a foot lands.
        let mut q = motion.q(frame).to_vec();
        let mean: Vec<f32> = motion
            .v(frame)
            .iter()
            .zip(motion.v(after))
            .map(|(a, b)| (a + b) / 2.0)
            .collect();
        drift(&model, &mean, (after - frame) as f32 / motion.rate, &mut q);
        ahead.push(apart(&model, &q, motion.q(after)));
    }
    let ahead = percentile(&mut ahead, 0.5);
    println!("over two frames {worst:.1e}, over one {ahead:.3} m or rad");
    assert!(worst < 1e-5, "{worst}");
    assert!(ahead < 0.05, "{ahead}");
}

/// The largest difference of two states, m or rad.
fn apart(model: &Model, one: &[f32], other: &[f32]) -> f32 {
    let differences = model.joints.iter().map(|joint| {
        let turned = |at: usize| {
            let [a, b] = [one, other].map(|q| quaternion(&q[joint.q + at..]));
            rotation_vector(a.inverse() * b).length()
        };
        match joint.kind {
            JointKind::Hinge => (one[joint.q] - other[joint.q]).abs(),
            JointKind::Ball => turned(0),
            JointKind::Free => {
                let [a, b] = [one, other].map(|q| Vec3::from_slice(&q[joint.q..]));
                a.distance(b).max(turned(3))
            }
        }
    });
    differences.fold(0.0, f32::max)
}

#[test]
fn joints_stay_within_their_ranges() {
    let (mut clip, roles) = performed();
    // Knees and elbows bent too far, and backwards.
    let joints = clip.skeleton.joints();
    for (frame, pose) in clip.rotations.chunks_exact_mut(joints).enumerate() {
        for rotation in &mut pose[1..] {
            *rotation *= Quat::from_rotation_x(0.02 * frame as f32);
        }
    }
    let (model, motion) = humanoid_and(&clip, &roles);
    for frame in 0..motion.frames {
        for joint in &model.joints {
            let (q, range) = (&motion.q(frame)[joint.q..], joint.range);
            let Some([least, most]) = range else { continue };
            let angle = match joint.kind {
                JointKind::Hinge => q[0],
                _ => quaternion(q).angle_between(Quat::IDENTITY),
            };
            let name = &joint.name;
            assert!(
                (least - 1e-3..=most + 1e-3).contains(&angle),
                "{frame} {name}: {angle}"
            );
        }
        assert!(
            motion
                .q(frame)
                .iter()
                .chain(motion.v(frame))
                .all(|x| x.is_finite())
        );
    }
}

#[test]
fn drives_targets_are_what_the_joints_do() {
    let (clip, roles) = performed();
    let (model, motion) = humanoid_and(&clip, &roles);
    let wanted = pd_targets(&model, motion.q(40));
    assert_eq!(wanted.len(), model.nu());
    // The humanoid's joints, but for the free one, are all driven.
    for joint in &model.joints[1..] {
        let q = &motion.q(40)[joint.q..];
        let wanted = &wanted[joint.v - 6..];
        match joint.kind {
            JointKind::Hinge => assert_eq!(wanted[0], q[0]),
            _ => {
                let rotation = Quat::from_scaled_axis(Vec3::from_slice(wanted));
                assert!(
                    rotation.dot(quaternion(q)).abs() > 1.0 - 1e-6,
                    "{}",
                    joint.name
                );
            }
        }
    }
}

#[test]
fn what_cannot_be_done_is_said() {
    let (clip, roles) = performed();
    let refused = |clip: &Clip, model: &Model| retarget(clip, &roles, model).expect_err("refused");
    let error = refused(&clip, &punching_box());
    assert!(matches!(error, RetargetError::Model { .. }));
    assert!(error.to_string().contains("'pelvis'"), "{error}");

    let mut short = clip.clone();
    short.positions.truncate(1);
    let error = refused(&short, &humanoid());
    assert!(
        matches!(error, RetargetError::Short { frames: 1, .. }),
        "{error}"
    );

    let mut kneeless = clip.clone();
    let knee = kneeless.skeleton.parents[roles.left_foot].expect("a knee");
    kneeless.skeleton.offsets[knee] = Vec3::ZERO;
    let error = refused(&kneeless, &humanoid());
    assert!(
        error.to_string().contains("no knee below 'LeftUpLeg'"),
        "{error}"
    );
}
