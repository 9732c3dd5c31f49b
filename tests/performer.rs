//! The synthetic performer keeps its feet on the ground, its joints in range and its variety.

use footwork::motion::RATE;
use footwork::motion::synthetic::{MINUTES, Take, perform, takes};
use glam::{Quat, Vec3};
use std::sync::LazyLock;

const SEED: u64 = 1;
static TAKES: LazyLock<Vec<Take>> = LazyLock::new(|| takes(SEED, MINUTES));

/// World positions of all joints, a frame at a time.
fn frames(take: &Take) -> impl Iterator<Item = Vec<Vec3>> + '_ {
    (0..take.clip.frames()).map(|frame| take.clip.world(frame).0)
}

fn joint(name: &str) -> usize {
    let names = &TAKES[0].clip.skeleton.names;
    names.iter().position(|other| other == name).expect(name)
}

fn sided(name: &str) -> [usize; 2] {
    ["Left", "Right"].map(|side| joint(&format!("{side}{name}")))
}

/// Degrees between two rotations.
fn degrees(a: Quat, b: Quat) -> f32 {
    a.angle_between(b).to_degrees()
}

/// Heading (rad) of each frame, from the hips-and-shoulders axis, unwrapped.
fn headings(take: &Take) -> Vec<f32> {
    let (hips, shoulders) = (sided("UpLeg"), sided("Arm"));
    let mut last = 0.0f32;
    frames(take)
        .map(|world| {
            let left = world[hips[0]] - world[hips[1]] + world[shoulders[0]] - world[shoulders[1]];
            let turned = (-left.z).atan2(left.x) - last;
            last += turned - std::f32::consts::TAU * (turned / std::f32::consts::TAU).round();
            last
        })
        .collect()
}

#[test]
fn lasts_as_long_as_asked_in_many_clips() {
    for minutes in [0.1, 1.0, MINUTES] {
        let (clips, _) = perform(SEED, minutes);
        let frames: usize = clips.iter().map(|clip| clip.frames()).sum();
        assert_eq!(frames, (minutes * 60.0 * RATE).round() as usize);
        assert!(
            clips
                .iter()
                .all(|clip| clip.rate == RATE && clip.seconds() <= 81.0)
        );
        assert!(clips.iter().all(|clip| clip.source.contains("synthetic")));
    }
    assert!(perform(SEED, 0.0).0.is_empty());
    assert!(TAKES.len() > 40);
}

#[test]
fn clips_are_well_formed() {
    let (clips, roles) = perform(SEED, 1.0);
    let clip = &clips[0];
    let joints = clip.skeleton.joints();
    assert_eq!(joints, 22);
    assert_eq!(clip.skeleton.offsets.len(), joints);
    assert_eq!(clip.rotations.len(), clip.frames() * joints);
    assert!(
        clip.rotations
            .iter()
            .all(|rotation| rotation.is_normalized())
    );
    assert!(clip.positions.iter().all(|position| position.is_finite()));
    for (index, parent) in clip.skeleton.parents.iter().enumerate() {
        assert!(parent.map_or(index == 0, |parent| parent < index));
    }
    assert_eq!(clip.skeleton.names[roles.hips], "Hips");
    assert_eq!(clip.skeleton.names[roles.left_foot], "LeftFoot");
    assert_eq!(clip.skeleton.names[roles.right_shoulder], "RightArm");
}

#[test]
fn the_seed_decides_every_bit() {
    let bits = |seed: u64| -> Vec<u32> {
        let (clips, _) = perform(seed, 3.0);
        clips
            .iter()
            .flat_map(|clip| {
                let positions = clip
                    .positions
                    .iter()
                    .flat_map(|position| position.to_array());
                let rotations = clip
                    .rotations
                    .iter()
                    .flat_map(|rotation| rotation.to_array());
                positions.chain(rotations).map(f32::to_bits)
            })
            .collect()
    };
    assert_eq!(bits(7), bits(7));
    assert_ne!(bits(7), bits(8));
}

#[test]
fn planted_toes_do_not_drift() {
    let toes = sided("Toe");
    let mut stances = 0;
    for take in TAKES.iter() {
        let mut since: [Option<Vec3>; 2] = [None; 2];
        for (world, planted) in frames(take).zip(&take.planted) {
            for side in 0..2 {
                let toe = world[toes[side]];
                let start = *since[side].get_or_insert_with(|| {
                    stances += usize::from(planted[side]);
                    toe
                });
                if planted[side] {
                    let drift = toe.distance(start);
                    assert!(drift < 0.01, "{}: {drift} m", take.clip.name);
                } else {
                    since[side] = None;
                }
            }
        }
    }
    assert!(stances > 3000, "{stances} stances");
}

#[test]
fn feet_stay_above_the_ground_and_clear_it_in_the_swing() {
    let (ankles, toes) = (sided("Foot"), sided("Toe"));
    let ends: Vec<_> = TAKES[0].clip.skeleton.ends[..2].to_vec();
    let mut swings = 0;
    let mut cleared = 0;
    for take in TAKES.iter() {
        let mut highest = [f32::INFINITY; 2];
        for frame in 0..take.clip.frames() {
            let (world, rotations) = take.clip.world(frame);
            for side in 0..2 {
                let (toe, tip) = ends[side];
                let tip = world[toe] + rotations[toe] * tip;
                let ankle = world[ankles[side]].y;
                assert!(tip.y.min(ankle).min(world[toes[side]].y) > -0.01);
                if !take.planted[frame][side] {
                    let before = if highest[side].is_finite() {
                        highest[side]
                    } else {
                        0.0
                    };
                    highest[side] = before.max(world[toes[side]].y.min(ankle - 0.06));
                } else if highest[side].is_finite() {
                    swings += 1;
                    cleared += usize::from(highest[side] > 0.03);
                    highest[side] = f32::INFINITY;
                }
            }
        }
    }
    // The exceptions are small adjusting steps.
    assert!(cleared * 100 > swings * 98, "{cleared} of {swings}");
}

#[test]
fn knees_bend_forwards_and_never_lock() {
    let (hips, knees, ankles) = (sided("UpLeg"), sided("Leg"), sided("Foot"));
    for take in TAKES.iter() {
        for frame in 0..take.clip.frames() {
            let (world, rotations) = take.clip.world(frame);
            for side in 0..2 {
                let thigh = world[knees[side]] - world[hips[side]];
                let shin = world[ankles[side]] - world[knees[side]];
                let hinge = rotations[knees[side]] * Vec3::X;
                let bend = thigh.angle_between(shin).to_degrees();
                assert!((2.0..150.0).contains(&bend), "{}: {bend}", take.clip.name);
                assert!(
                    thigh.cross(shin).dot(hinge) > 0.0,
                    "{} {frame}",
                    take.clip.name
                );
                // The hinge stays across the body.
                assert!(
                    hinge.dot(rotations[0] * Vec3::X) > 0.3,
                    "{} {frame}",
                    take.clip.name
                );
            }
        }
    }
}

#[test]
fn nothing_jumps() {
    for take in TAKES.iter() {
        let clip = &take.clip;
        for triple in clip.positions.windows(3) {
            let acceleration = (triple[2] - 2.0 * triple[1] + triple[0]) * RATE * RATE;
            assert!(
                acceleration.length() < 40.0,
                "{}: {acceleration}",
                clip.name
            );
        }
        for frame in 1..clip.frames() {
            for (&before, &after) in clip.pose(frame - 1).iter().zip(clip.pose(frame)) {
                let turned = degrees(before, after);
                assert!(turned < 50.0, "{} at {frame}: {turned}", clip.name);
            }
        }
    }
}

#[test]
fn hips_keep_a_human_height_and_legs_do_not_touch() {
    let ankles = sided("Foot");
    for take in TAKES.iter() {
        for world in frames(take) {
            assert!((0.6..0.96).contains(&world[0].y), "{}", world[0].y);
            assert!(world[ankles[0]].distance(world[ankles[1]]) > 0.05);
        }
    }
}

#[test]
fn hips_move_as_planned() {
    /// Frames over which sway and bob average out: about a stride.
    const WINDOW: usize = 30;
    for take in TAKES.iter() {
        for (positions, plan) in take
            .clip
            .positions
            .windows(WINDOW + 1)
            .zip(take.velocity.windows(WINDOW + 1))
        {
            let moved = (positions[WINDOW] - positions[0]) * Vec3::new(1.0, 0.0, 1.0);
            let planned = plan[1..].iter().sum::<Vec3>() / RATE;
            assert!(moved.distance(planned) < 0.15, "{}", take.clip.name);
        }
    }
}

/// Speed (m/s), turning (degrees/s) and the velocity's parts along and across the heading.
struct Row {
    speed: f32,
    turn: f32,
    ahead: f32,
    left: f32,
}

#[test]
fn covers_speeds_turns_and_directions() {
    /// Frames over which speed and turning are measured.
    const WINDOW: usize = 9;
    let mut rows = Vec::new();
    for take in TAKES.iter() {
        let headings = headings(take);
        for frame in 0..take.clip.frames() - WINDOW {
            let seconds = WINDOW as f32 / RATE;
            let (from, to) = (
                take.clip.positions[frame],
                take.clip.positions[frame + WINDOW],
            );
            let velocity = (to - from) * Vec3::new(1.0, 0.0, 1.0) / seconds;
            let turn = (headings[frame + WINDOW] - headings[frame]).to_degrees() / seconds;
            let (sin, cos) = headings[frame + WINDOW / 2].sin_cos();
            let ahead = velocity.x * sin + velocity.z * cos;
            let left = velocity.x * cos - velocity.z * sin;
            rows.push(Row {
                speed: velocity.length(),
                turn,
                ahead,
                left,
            });
        }
    }
    let share = |want: &dyn Fn(&Row) -> bool| {
        rows.iter().filter(|row| want(row)).count() as f32 / rows.len() as f32
    };
    let check = |what: &str, found: f32, low: f32, high: f32| {
        println!("{what}: {:.1} %", 100.0 * found);
        assert!((low..high).contains(&found), "{what}: {found}");
    };
    check("standing", share(&|row| row.speed < 0.2), 0.10, 0.22);
    check(
        "walking",
        share(&|row| (0.2..2.2).contains(&row.speed)),
        0.5,
        0.7,
    );
    check("running", share(&|row| row.speed >= 2.2), 0.18, 0.32);
    check("full speed", share(&|row| row.speed > 3.5), 0.06, 0.2);
    check("fastest", share(&|row| row.speed > 4.4), 0.003, 0.1);
    check("turning", share(&|row| row.turn.abs() > 60.0), 0.15, 0.3);
    check(
        "turning left fast",
        share(&|row| row.turn > 180.0),
        0.005,
        0.1,
    );
    check(
        "turning right fast",
        share(&|row| row.turn < -180.0),
        0.005,
        0.1,
    );
    check(
        "on the spot",
        share(&|row| row.speed < 0.4 && row.turn.abs() > 60.0),
        0.02,
        0.1,
    );
    check(
        "fast curves",
        share(&|row| row.speed > 3.0 && row.turn.abs() > 60.0),
        0.005,
        0.1,
    );
    check(
        "backwards",
        share(&|row| row.ahead < -0.4 && row.left.abs() < -row.ahead),
        0.03,
        0.1,
    );
    check(
        "to the left",
        share(&|row| row.left > 0.4 && row.ahead.abs() < row.left),
        0.015,
        0.1,
    );
    check(
        "to the right",
        share(&|row| row.left < -0.4 && row.ahead.abs() < -row.left),
        0.015,
        0.1,
    );
}
