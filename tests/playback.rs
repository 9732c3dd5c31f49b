//! Playback against what it must leave alone, what it must hold, and how good it must look.

use footwork::env::locomotion::{LocomotionTask, Plane};
use footwork::matching::MotionMatcher;
use footwork::motion::database::Database;
use footwork::motion::normalise::Weights;
use footwork::motion::skeleton::JointTransforms;
use footwork::motion::synthetic;
use footwork::playback::leg::{LegJoints, legs};
use footwork::playback::player::{Feet, Style};
use footwork::playback::quality::compare;
use footwork::playback::stitch::Stitching;
use footwork::playback::two_bone_ik;
use footwork::playback::{CharacterPose, PlacedFrame, Player};
use footwork::train::controller::Scripted;
use footwork::train::rendered_frames::rendered_frames;
use glam::{Quat, Vec3};
use rand::rngs::SmallRng;
use rand::{RngExt, SeedableRng};
use std::sync::{Arc, LazyLock};

static DATABASE: LazyLock<Arc<Database>> = LazyLock::new(|| {
    let (clips, roles) = synthetic::perform(1, 4.0);
    Arc::new(Database::build(&clips, roles, Weights::PAPER).unwrap())
});
static FEET: LazyLock<Arc<Feet>> = LazyLock::new(|| Arc::new(Feet::of(&DATABASE)));

fn player(style: Style, from: PlacedFrame) -> Player {
    Player::new(DATABASE.clone(), FEET.clone(), style, from)
}

fn solve(pose: &mut CharacterPose, leg: &LegJoints, target: Vec3) {
    let mut world = JointTransforms::default();
    two_bone_ik::solve(&DATABASE.skeleton, pose, leg, target, &mut world);
}

fn at(frame: usize) -> PlacedFrame {
    PlacedFrame {
        frame,
        at: [3.0, -2.0],
        heading: [0.6, -0.8],
    }
}

/// Largest distance between the joints of two poses, m.
fn apart(a: &CharacterPose, b: &CharacterPose) -> f32 {
    let [(a, _), (b, _)] = [a, b].map(|pose| pose.world(&DATABASE.skeleton));
    let distances = a.iter().zip(&b).map(|(a, b)| a.distance(*b));
    distances.fold(0.0, f32::max)
}

#[test]
fn walking_on_is_the_recording_moved_as_a_whole() {
    let joints = DATABASE.skeleton.joints();
    for frame in [0, 100, 700] {
        let begun = at(frame).pose(&DATABASE);
        let turn = begun.rotations[0] * DATABASE.rotations[frame * joints].inverse();
        for ahead in [1, 6, 25] {
            let later = at(frame).on(&DATABASE, ahead as isize).pose(&DATABASE);
            let moved = DATABASE.hips[frame + ahead] - DATABASE.hips[frame];
            let recorded = CharacterPose {
                root: begun.root + turn * moved,
                rotations: (0..joints)
                    .map(|joint| {
                        let local = DATABASE.rotations[(frame + ahead) * joints + joint];
                        if joint == 0 { turn * local } else { local }
                    })
                    .collect(),
            };
            assert!(apart(&later, &recorded) < 1e-4, "frame {frame} + {ahead}");
        }
    }
}

#[test]
fn a_recording_without_jumps_is_shown_as_it_is() {
    for stitching in [Stitching::None, Stitching::Linear, Stitching::Inertialize] {
        let style = Style {
            stitching,
            foot_locking: false,
        };
        let mut player = player(style, at(50));
        for ahead in 1..60 {
            let shown = at(50).on(&DATABASE, ahead);
            assert!(apart(player.next(shown), &shown.pose(&DATABASE)) < 1e-5);
        }
    }
}

#[test]
fn a_seam_begins_with_the_old_motion_and_ends_with_the_new() {
    let (old, new) = (at(200), at(1500));
    for stitching in [Stitching::Linear, Stitching::Inertialize] {
        let style = Style {
            stitching,
            foot_locking: false,
        };
        let mut player = player(style, old);
        let first = player.next(new).clone();
        let going_on = old.on(&DATABASE, 1).pose(&DATABASE);
        assert!(apart(&first, &new.pose(&DATABASE)) > 0.1, "no jump to hide");
        assert!(apart(&first, &going_on) < 1e-4, "{stitching:?}");
        let mut last = first;
        for ahead in 1..=12 {
            last.clone_from(player.next(new.on(&DATABASE, ahead)));
        }
        assert!(apart(&last, &new.on(&DATABASE, 12).pose(&DATABASE)) < 1e-4);
    }
}

#[test]
fn legs_reach_what_they_can_and_bend_their_knees_forward() {
    let mut random = SmallRng::seed_from_u64(5);
    let skeleton = &DATABASE.skeleton;
    for leg in legs(&DATABASE) {
        let length = skeleton.reach(leg.hip, leg.foot);
        for _ in 0..500 {
            let frame = random.random_range(0..DATABASE.frames());
            let mut pose = at(frame).pose(&DATABASE);
            let (before, turned) = pose.world(skeleton);
            let shift = Vec3::from_array([0.0; 3].map(|_: f32| random.random_range(-0.3..0.3)));
            let target = before[leg.foot] + shift;
            let hip = before[leg.hip];
            solve(&mut pose, &leg, target);
            let (after, turned_after) = pose.world(skeleton);
            let wanted = target.distance(hip);
            if wanted < 0.95 * length && wanted > 0.1 {
                assert!(after[leg.foot].distance(target) < 1e-3, "{after:?}");
            } else if wanted > length {
                let (way, got) = ((target - hip).normalize(), after[leg.foot] - hip);
                assert!(got.normalize().dot(way) > 0.9999 && got.length() <= length + 1e-4);
            }
            // The foot keeps its rotation, and the knee its direction.
            assert!(turned[leg.foot].angle_between(turned_after[leg.foot]) < 2e-3);
            let (thigh, shank) = (after[leg.knee] - hip, after[leg.foot] - after[leg.knee]);
            let bend = thigh.cross(shank).dot(turned_after[leg.hip] * leg.axis);
            assert!(bend > -1e-3, "a knee bent backwards: {bend}");
        }
    }
}

#[test]
fn reaching_where_the_foot_already_is_changes_nothing() {
    for leg in legs(&DATABASE) {
        for frame in (0..DATABASE.frames()).step_by(37) {
            let recorded = at(frame).pose(&DATABASE);
            let mut pose = recorded.clone();
            let (positions, _) = pose.world(&DATABASE.skeleton);
            solve(&mut pose, &leg, positions[leg.foot]);
            assert!(apart(&pose, &recorded) < 1e-3, "frame {frame}");
        }
    }
}

#[test]
fn a_target_nobody_can_reach_leaves_numbers() {
    for leg in legs(&DATABASE) {
        for target in [Vec3::splat(1e6), Vec3::ZERO, at(9).pose(&DATABASE).root] {
            let mut pose = at(9).pose(&DATABASE);
            solve(&mut pose, &leg, target);
            let finite = |q: &Quat| q.is_finite() && q.is_normalized();
            assert!(pose.rotations.iter().all(finite));
        }
    }
}

/// Scripted motion matching requests straight walks; its motion must look as the bars say.
#[test]
fn shown_motion_stays_near_the_recordings() {
    let scripted = Scripted {
        database: &DATABASE,
        speed: 1.6,
    };
    let matcher = Arc::new(MotionMatcher::new(DATABASE.clone()));
    let task = LocomotionTask::Plane(Plane::default());
    let episodes = rendered_frames(&scripted, &matcher, task, 40).unwrap();
    let found = compare(&DATABASE, &episodes);
    assert!(found.jumps > 50, "{found:?}");
    assert!(found.locked.foot_skate_cm_s < 1.5, "{found:?}");
    assert!(
        found.locked.foot_skate_cm_s < 0.2 * found.raw.foot_skate_cm_s,
        "{found:?}"
    );
    assert!(found.locked.penetration_max_cm < 1.0, "{found:?}");
    assert!(found.stitched.jerk < 1.5 * found.recorded.jerk, "{found:?}");
    assert!(found.locked.jerk < 1.5 * found.recorded.jerk, "{found:?}");
    assert!(found.raw.jerk > 2.0 * found.recorded.jerk, "{found:?}");
}
