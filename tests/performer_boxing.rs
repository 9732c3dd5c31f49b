//! The performer boxes with its feet on the ground, its guard up and its fists fast.

use footwork::motion::RATE;
use footwork::motion::synthetic::boxing::{
    BoxingStep, BoxingTake, PunchKind, PunchTarget, ThrownPunch, boxing_takes,
};
use footwork::motion::synthetic::{perform, perform_boxing};
use footwork::physics::humanoid::humanoid;
use footwork::physics::kinematics::kinematics;
use footwork::physics::model::Model;
use footwork::physics::pose::Pose;
use footwork::physics::retarget::retarget;
use footwork::physics::spatial::Spatial;
use glam::{Quat, Vec3, vec3};
use std::collections::HashSet;
use std::sync::LazyLock;

const SEED: u64 = 1;
const MINUTES: f32 = 10.0;
static TAKES: LazyLock<Vec<BoxingTake>> = LazyLock::new(|| boxing_takes(SEED, MINUTES));
const FLAT: Vec3 = vec3(1.0, 0.0, 1.0);

fn joint(name: &str) -> usize {
    let names = &TAKES[0].clip.skeleton.names;
    names.iter().position(|other| other == name).expect(name)
}

fn sided(name: &str) -> [usize; 2] {
    ["Left", "Right"].map(|side| joint(&format!("{side}{name}")))
}

/// World positions and rotations of all joints, a frame at a time.
fn frames(take: &BoxingTake) -> Vec<(Vec<Vec3>, Vec<Quat>)> {
    let frames = 0..take.clip.frames();
    frames.map(|frame| take.clip.world(frame)).collect()
}

/// Leftwards of where the head looks, over the ground.
fn leftwards(rotations: &[Quat]) -> Vec3 {
    (rotations[joint("Head")] * Vec3::X * FLAT).normalize()
}

/// The value that this share of all are below.
fn quantile(values: &mut [f32], share: f32) -> f32 {
    values.sort_by(f32::total_cmp);
    values[((values.len() - 1) as f32 * share) as usize]
}

#[test]
fn lasts_as_long_as_asked_in_clips_of_half_a_minute() {
    let (clips, roles) = perform_boxing(SEED, MINUTES);
    let frames: usize = clips.iter().map(|clip| clip.frames()).sum();
    assert_eq!(frames, (MINUTES * 60.0 * RATE).round() as usize);
    for (index, clip) in clips.iter().enumerate() {
        assert_eq!(clip.name, format!("boxing_{index:03}"));
        assert!((20.0..50.0).contains(&clip.seconds()), "{}", clip.seconds());
        assert!(
            clip.rotations
                .iter()
                .all(|rotation| rotation.is_normalized())
        );
        assert!(clip.positions.iter().all(|position| position.is_finite()));
    }
    let (walking, walkers) = perform(SEED, 0.5);
    assert_eq!(clips[0].skeleton, walking[0].skeleton);
    assert_eq!(roles, walkers);
    assert!(perform_boxing(SEED, 0.0).0.is_empty());
}

#[test]
fn the_seed_decides_every_bit() {
    let bits = |seed: u64| -> Vec<u32> {
        let (clips, _) = perform_boxing(seed, 2.0);
        let numbers = clips.iter().flat_map(|clip| {
            let positions = clip.positions.iter().flat_map(|p| p.to_array());
            let rotations = clip.rotations.iter().flat_map(|r| r.to_array());
            positions.chain(rotations)
        });
        numbers.map(f32::to_bits).collect()
    };
    assert_eq!(bits(7), bits(7));
    assert_ne!(bits(7), bits(8));
}

#[test]
fn planted_toes_stay_where_they_are() {
    let toes = sided("Toe");
    let mut stances = 0;
    for take in TAKES.iter() {
        let mut since: [Option<Vec3>; 2] = [None; 2];
        for ((at, _), planted) in frames(take).iter().zip(&take.planted) {
            for side in 0..2 {
                if !planted[side] {
                    stances += usize::from(since[side].is_some());
                    since[side] = None;
                    continue;
                }
                let toe = at[toes[side]];
                let drift = toe.distance(*since[side].get_or_insert(toe));
                assert!(drift < 1e-4, "{}: {drift} m", take.clip.name);
            }
        }
    }
    assert!(stances > 500, "{stances} stances");
}

#[test]
fn feet_never_cross_nor_sink() {
    let (ankles, toes) = (sided("Foot"), sided("Toe"));
    for take in TAKES.iter() {
        for (at, rotations) in frames(take) {
            let left = leftwards(&rotations);
            let apart = (at[ankles[0]] - at[ankles[1]]).dot(left);
            assert!(apart > 0.05, "{}: {apart} m", take.clip.name);
            let lowest = toes.map(|toe| at[toe].y).into_iter().fold(1.0, f32::min);
            assert!(lowest > 0.015, "{}: {lowest} m", take.clip.name);
        }
    }
}

#[test]
fn one_foot_stands_at_all_times() {
    for take in TAKES.iter() {
        assert!(take.planted.iter().all(|[left, right]| *left || *right));
    }
}

#[test]
fn hips_are_between_the_feet() {
    let (hips, ankles) = (joint("Hips"), sided("Foot"));
    for take in TAKES.iter() {
        for (at, _) in frames(take) {
            let base = (at[ankles[0]] - at[ankles[1]]) * FLAT;
            let share = (at[hips] - at[ankles[1]]).dot(base) / base.length_squared();
            assert!((0.0..1.0).contains(&share), "{}: {share}", take.clip.name);
            assert!((0.65..0.92).contains(&at[hips].y), "{}", at[hips].y);
        }
    }
}

/// Degrees between two bones that meet in a joint.
fn bend(at: &[Vec3], [top, middle, end]: [usize; 3]) -> f32 {
    (at[middle] - at[top])
        .angle_between(at[end] - at[middle])
        .to_degrees()
}

#[test]
fn joints_stay_within_human_ranges() {
    let chain = |names: [&str; 3], side: usize| names.map(|name| sided(name)[side]);
    for take in TAKES.iter() {
        for (frame, (at, _)) in frames(take).iter().enumerate() {
            let pose = take.clip.pose(frame);
            for side in 0..2 {
                let elbow = bend(at, chain(["Arm", "ForeArm", "Hand"], side));
                assert!((8.0..148.0).contains(&elbow), "elbow {elbow}");
                let knee = bend(at, chain(["UpLeg", "Leg", "Foot"], side));
                assert!((5.0..120.0).contains(&knee), "knee {knee}");
            }
            for (name, most) in [
                ("LeftFoot", 55.0),
                ("RightFoot", 55.0),
                ("LeftUpLeg", 110.0),
                ("RightUpLeg", 110.0),
                ("Spine", 25.0),
                ("Spine1", 25.0),
                ("Spine2", 25.0),
                ("Neck", 45.0),
                ("Head", 45.0),
            ] {
                let angle = pose[joint(name)].angle_between(Quat::IDENTITY).to_degrees();
                assert!(angle < most, "{name}: {angle} in {}", take.clip.name);
            }
        }
    }
}

#[test]
fn elbows_are_hinges_that_stay_down_in_guard() {
    let (shoulders, elbows, hands) = (sided("Arm"), sided("ForeArm"), sided("Hand"));
    for take in TAKES.iter() {
        for (frame, (at, _)) in frames(take).iter().enumerate() {
            for side in 0..2 {
                let fold = take.clip.pose(frame)[elbows[side]];
                assert!(fold.x == 0.0 && fold.z == 0.0, "{fold}");
                if in_guard(take, side, frame) {
                    let (shoulder, elbow, hand) =
                        (at[shoulders[side]], at[elbows[side]], at[hands[side]]);
                    assert!(elbow.y < shoulder.y - 0.1 && elbow.y < hand.y - 0.1);
                }
            }
        }
    }
}

fn in_guard(take: &BoxingTake, side: usize, frame: usize) -> bool {
    let time = frame as f32 / RATE;
    let mut punches = take
        .punches
        .iter()
        .filter(|punch| punch.kind.side() == side);
    !punches.any(|punch| (punch.start..punch.end()).contains(&time))
}

#[test]
fn hands_are_up_at_all_times_and_in_guard_at_the_chin() {
    let (hips, head, hands) = (joint("Hips"), joint("Head"), sided("Hand"));
    for take in TAKES.iter() {
        for (frame, (at, _)) in frames(take).iter().enumerate() {
            for side in 0..2 {
                let hand = at[hands[side]];
                assert!(hand.y > at[hips].y + 0.1, "{}", take.clip.name);
                if in_guard(take, side, frame) {
                    let away = hand.distance(at[head]);
                    assert!((0.1..0.4).contains(&away), "{away} m");
                }
            }
        }
    }
}

/// The greatest speed of the fist on its way out (m/s).
fn peak(take: &BoxingTake, at: &[(Vec<Vec3>, Vec<Quat>)], punch: &ThrownPunch) -> Option<f32> {
    let hand = sided("Hand")[punch.kind.side()];
    let [from, to] = [punch.start, punch.turn()].map(|time| (time * RATE) as usize);
    (to + 1 < take.clip.frames()).then(|| {
        let steps = from..=to;
        let speeds = steps.map(|frame| at[frame].0[hand].distance(at[frame + 1].0[hand]) * RATE);
        speeds.fold(0.0, f32::max)
    })
}

#[test]
fn fists_are_as_fast_as_a_boxers() {
    for kind in PunchKind::ALL {
        let mut peaks = Vec::new();
        for take in TAKES.iter() {
            let at = frames(take);
            let punches = take.punches.iter().filter(|punch| punch.kind == kind);
            peaks.extend(punches.filter_map(|punch| peak(take, &at, punch)));
        }
        let [least, slow, usual, most] =
            [0.0, 0.1, 0.5, 1.0].map(|share| quantile(&mut peaks, share));
        println!(
            "{kind:?}: {} times, {least:.1}, {usual:.1}, {most:.1} m/s",
            peaks.len()
        );
        assert!(
            least > 3.4 && slow > 4.0,
            "{kind:?}: {least} m/s, {slow} m/s"
        );
        assert!((4.2..6.0).contains(&usual), "{kind:?}: {usual} m/s");
        assert!(most < 7.0, "{kind:?}: {most} m/s");
    }
}

#[test]
fn punches_reach_far_ahead_at_the_height_of_their_target() {
    let (neck, hands) = (joint("Neck"), sided("Hand"));
    for take in TAKES.iter() {
        let at = frames(take);
        for punch in &take.punches {
            let apex = (punch.apex() * RATE).round() as usize;
            let Some((at, rotations)) = at.get(apex) else {
                continue;
            };
            let fist = at[hands[punch.kind.side()]];
            let ahead = (rotations[joint("Head")] * Vec3::Z * FLAT).normalize();
            let reach = (fist - at[neck]).dot(ahead);
            assert!(reach > 0.3, "{punch:?}: {reach} m");
            let heights = match punch.target {
                PunchTarget::Head => 1.25..1.6,
                PunchTarget::Body => 0.9..1.25,
            };
            assert!(heights.contains(&fist.y), "{punch:?}: {} m", fist.y);
        }
    }
}

/// Turning of a pair of joints about up against where the head looks, positive to the left (rad).
fn turning((at, rotations): &(Vec<Vec3>, Vec<Quat>), [left, right]: [usize; 2]) -> f32 {
    let (straight, across) = (leftwards(rotations), (at[left] - at[right]) * FLAT);
    straight.cross(across).y.atan2(straight.dot(across))
}

#[test]
fn hips_turn_into_a_cross_before_the_shoulders_and_the_fist_is_last() {
    let (hips, shoulders, hand) = (sided("UpLeg"), sided("Arm"), sided("Hand")[1]);
    let mut latest = [0.0; 3];
    for take in TAKES.iter() {
        let at = frames(take);
        for punch in take.punches.iter().filter(|p| p.kind == PunchKind::Cross) {
            let [from, to] = [punch.start - 0.1, punch.turn()].map(|t| (t * RATE) as usize);
            let Some(frames) = at.get(from..=to) else {
                continue;
            };
            let [first, last] = [0, to - from].map(|frame| turning(&frames[frame], shoulders));
            assert!(first < -0.3 && last > 0.3, "from {first} to {last}");
            let turned = |joints| {
                let yaws = frames.iter().map(|frame| turning(frame, joints));
                yaws.collect::<Vec<f32>>()
            };
            let reached = frames
                .iter()
                .map(|frame| -frame.0[hand].distance(frames[to - from].0[hand]));
            for (sum, way) in
                latest
                    .iter_mut()
                    .zip([turned(hips), turned(shoulders), reached.collect()])
            {
                *sum += fastest(&way);
            }
        }
    }
    println!("{latest:?}");
    assert!(latest.is_sorted(), "{latest:?}");
}

/// The step in which something grows most.
fn fastest(values: &[f32]) -> f32 {
    let steps = values.windows(2).map(|pair| pair[1] - pair[0]).enumerate();
    let fastest = steps.max_by(|a, b| a.1.total_cmp(&b.1));
    fastest.map_or(0.0, |(step, _)| step as f32)
}

#[test]
fn nothing_jumps() {
    for take in TAKES.iter() {
        let clip = &take.clip;
        for triple in clip.positions.windows(3) {
            let acceleration = ((triple[2] - 2.0 * triple[1] + triple[0]) * RATE * RATE).length();
            assert!(acceleration < 10.0, "{}: {acceleration}", clip.name);
        }
        for frame in 1..clip.frames() - 1 {
            let poses = [frame - 1, frame, frame + 1].map(|frame| clip.pose(frame));
            for (index, name) in clip.skeleton.names.iter().enumerate() {
                let [before, now, after] = poses.map(|pose| pose[index]);
                let change = velocity(now, after) - velocity(before, now);
                let acceleration = change.length() * RATE;
                assert!(acceleration < 1200.0, "{name} at {frame}: {acceleration}");
            }
        }
    }
}

/// rad/s
fn velocity(from: Quat, to: Quat) -> Vec3 {
    let turned = from.inverse() * to;
    let shorter = if turned.w < 0.0 { -turned } else { turned };
    shorter.to_scaled_axis() * RATE
}

#[test]
fn every_punch_and_every_way_of_stepping_appears() {
    let punches = TAKES.iter().flat_map(|take| &take.punches);
    let kinds: HashSet<_> = punches.map(|punch| (punch.kind, punch.target)).collect();
    assert_eq!(kinds.len(), 8);

    let steps: Vec<_> = TAKES.iter().flat_map(|take| &take.steps).collect();
    let eighths = steps.iter().filter(|step| step.length > 0.0).map(|step| {
        let eighth = step.bearing / std::f32::consts::FRAC_PI_4;
        (eighth.round() as i32).rem_euclid(8)
    });
    assert_eq!(eighths.collect::<HashSet<_>>().len(), 8);
    let pivots = steps.iter().filter(|step| step.length == 0.0);
    let turns: Vec<f32> = pivots.map(|step| step.turn.to_degrees()).collect();
    assert!(turns.iter().any(|&turn| turn > 40.0) && turns.iter().any(|&turn| turn < -40.0));
    assert!(turns.iter().all(|turn| turn.abs() <= 60.0));
}

#[test]
fn closes_the_distance_at_a_boxers_speed() {
    let seconds = |step: &BoxingStep| step.to - step.from;
    let fast =
        |pair: &[BoxingStep]| pair[0].bearing.abs() < 0.3 && pair[1].from - pair[0].to < 0.01;
    let mut speeds = Vec::new();
    for take in TAKES.iter() {
        let pairs = take.steps.windows(2).filter(|pair| fast(pair));
        speeds.extend(pairs.map(|pair| pair[0].length / seconds(&pair[0])));
    }
    assert!(speeds.len() > 50, "{} steps", speeds.len());
    assert!(speeds.iter().all(|speed| (0.75..1.25).contains(speed)));
}

/// Poses of the simulated humanoid's bodies at each frame.
fn humanoid_poses(model: &Model, take: &BoxingTake) -> Vec<Vec<Pose>> {
    let (_, roles) = perform_boxing(SEED, 0.0);
    let motion = retarget(&take.clip, &roles, model).expect("the performer's skeleton");
    let mut axes = vec![Spatial::default(); model.nv()];
    let mut poses = vec![Pose::default(); model.bodies.len()];
    let frames = (0..motion.frames).map(|frame| {
        kinematics(model, motion.q(frame), &mut poses, &mut axes);
        poses.clone()
    });
    frames.collect()
}

#[test]
fn the_humanoid_stands_on_the_ground_in_balance() {
    let model = humanoid();
    let feet = ["left_foot", "right_foot"].map(|name| model.body(name).expect(name));
    let soles = model
        .geoms
        .iter()
        .filter(|geom| geom.body.is_some_and(|body| feet.contains(&body)));
    let soles: Vec<_> = soles.collect();
    let mass: f32 = model.bodies.iter().map(|body| body.mass).sum();
    for take in &TAKES[..4] {
        for (poses, planted) in humanoid_poses(&model, take).iter().zip(&take.planted) {
            let lowest = soles.iter().map(|sole| sole.lowest_point(poses));
            let lowest = lowest.fold(f32::INFINITY, f32::min);
            assert!((-0.01..0.02).contains(&lowest), "{lowest} m");
            if *planted != [true, true] {
                continue;
            }
            let bodies = model.bodies.iter().zip(poses);
            let centre: Vec3 = bodies
                .map(|(body, pose)| pose.at(body.com) * body.mass)
                .sum();
            let [left, right] = feet.map(|foot| poses[foot].position);
            let base = (left - right) * vec3(1.0, 1.0, 0.0);
            let over = (centre / mass - right) * vec3(1.0, 1.0, 0.0);
            let share = over.dot(base) / base.length_squared();
            let aside = (over - share * base).length();
            assert!(
                (0.0..1.0).contains(&share) && aside < 0.15,
                "{share} {aside}"
            );
        }
    }
}
