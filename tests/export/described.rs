//! What is said of exported policies, against what they are given.

use super::cases::{CASES, Files, UntrainedRun};
use footwork::env::humanoid::driver::DriverState;
use footwork::env::humanoid::task::CpuHumanoidEnv;
use footwork::env::humanoid::task::play::play;
use footwork::env::locomotion::{CpuLocomotion, EnvConfig};
use footwork::env::{ObservationSpec, VecEnv};
use footwork::kernels::locomotion::locomotion_layout::state_f32;
use footwork::motion::character_frame::to_world;
use footwork::physics::kinematics::quaternion;
use glam::{Quat, Vec2, Vec3};
use safetensors::SafeTensors;
use serde_json::Value;
use std::collections::BTreeSet;

/// What is said of a policy.
pub fn description(run: &UntrainedRun) -> Value {
    let file = run.exported("safetensors");
    let (_, header) = SafeTensors::read_metadata(&file).unwrap();
    let metadata = header.metadata().as_ref().unwrap();
    assert_eq!(metadata["task"], run.config.task.name);
    let description: Value = serde_json::from_str(&metadata["footwork"]).unwrap();
    assert_eq!(
        metadata["data_fingerprint"],
        description["data_fingerprint"]
    );
    description
}

fn ports<'a>(description: &'a Value, side: &str) -> impl Iterator<Item = &'a Value> {
    description[side].as_array().unwrap().iter()
}

fn texts(value: &Value) -> Vec<&str> {
    let texts = value.as_array().unwrap().iter();
    texts.map(|text| text.as_str().unwrap()).collect()
}

fn floats(value: &Value) -> Vec<f32> {
    serde_json::from_value(value.clone()).unwrap()
}

#[test]
fn every_number_of_every_policy_has_a_meaning() {
    for (run, recorded) in CASES.iter() {
        let description = description(run);
        let rows = recorded.outputs["action"].len() / shape(&description, "outputs", "action");
        for (side, given) in [("inputs", &recorded.inputs), ("outputs", &recorded.outputs)] {
            let names = ports(&description, side).map(|port| port["name"].as_str().unwrap());
            let names: BTreeSet<&str> = names.collect();
            assert_eq!(
                names,
                given.keys().copied().collect(),
                "{} {side}",
                run.name
            );
            for port in ports(&description, side) {
                let name = port["name"].as_str().unwrap();
                let size = shape(&description, side, name);
                assert_eq!(given[name].len(), rows * size, "{} {name}", run.name);
                if port["maps"].is_null() {
                    parts_cover(port, size, run);
                }
            }
        }
        assert_eq!(
            description["low_level_fingerprint"].is_string(),
            run.task.low_level().is_some()
        );
        // Where a number has a frame of reference, the frame is explained.
        let frames = description["frames"].as_object().unwrap();
        let all = ports(&description, "inputs").chain(ports(&description, "outputs"));
        for part in all.filter_map(|port| port["parts"].as_array()).flatten() {
            let frame = part["frame"].as_str().unwrap();
            assert!(
                frame == "none" || frames.contains_key(frame),
                "{}: {frame}",
                run.name
            );
        }
    }
}

fn shape(description: &Value, side: &str, name: &str) -> usize {
    let port = ports(description, side)
        .find(|port| port["name"] == name)
        .unwrap();
    let sizes = port["shape"].as_array().unwrap().iter();
    sizes.map(|size| size.as_u64().unwrap() as usize).product()
}

/// Parts lie one behind another and have names of their own.
fn parts_cover(port: &Value, size: usize, run: &UntrainedRun) {
    let (mut end, mut names) = (0, BTreeSet::new());
    for part in port["parts"].as_array().unwrap() {
        assert_eq!(part["first"], end, "{} {part}", run.name);
        let elements = texts(&part["elements"]);
        let unique: BTreeSet<&&str> = elements.iter().collect();
        assert!(unique.len() == elements.len() && names.insert(part["name"].as_str().unwrap()));
        for encoding in ["mean", "scale"] {
            assert!(part[encoding].is_null() || floats(&part[encoding]).len() == elements.len());
        }
        end += elements.len();
    }
    assert_eq!(end, size, "{} {}", run.name, port["name"]);
}

/// Quantities that a body observes, by the names of the parts.
struct Observed {
    description: Value,
    env: CpuHumanoidEnv,
}

impl Observed {
    /// Some steps into an episode.
    fn after_steps(task: &str) -> Observed {
        let run = Files::new().run(task);
        let mut env = run.task.body().unwrap().open(3);
        let driver = run.task.driver(&run.checkpoint.policy);
        let mut steps = 0;
        play(&mut env, &*driver, DriverState::default(), |_, _, _| {
            steps += 1;
            steps < 5
        });
        let description = description(&run);
        Observed { description, env }
    }

    /// A part's quantity, as its mean and scale say.
    fn of(&self, name: &str) -> Vec<f32> {
        let port = &self.description["inputs"][0];
        let part = port["parts"].as_array().unwrap().iter();
        let part = part.clone().find(|part| part["name"] == name);
        let part = part.unwrap_or_else(|| panic!("no part {name}"));
        let (first, count) = (
            part["first"].as_u64().unwrap() as usize,
            texts(&part["elements"]).len(),
        );
        let numbers = self.env.seen(0)[first..first + count].iter().enumerate();
        let encoding = |name: &str, at: usize| {
            part[name]
                .as_array()
                .map(|all| all[at].as_f64().unwrap() as f32)
        };
        let quantity = |(at, number): (usize, &f32)| {
            number / encoding("scale", at).unwrap_or(1.0) + encoding("mean", at).unwrap_or(0.0)
        };
        numbers.map(quantity).collect()
    }

    fn q(&self) -> &[f32] {
        &self.env.batch.worlds[0].state.q
    }

    /// The first of a joint's positions.
    fn joint(&self, name: &str) -> usize {
        let joints = self.env.task().model().joints.iter();
        let joint = joints
            .clone()
            .find(|joint| joint.name.rsplit('/').next() == Some(name));
        joint.unwrap().q
    }

    /// A vector of the world in the heading frame, as the frames say.
    fn in_heading(&self, vector: Vec3) -> Vec3 {
        let forward = (quaternion(&self.q()[3..]) * Vec3::X)
            .truncate()
            .normalize();
        let yaw = forward.y.atan2(forward.x);
        Quat::from_rotation_z(-yaw) * vector
    }

    fn root(&self) -> Vec3 {
        Vec3::from_slice(self.q())
    }
}

fn near(found: &[f32], wanted: &[f32]) {
    assert_eq!(found.len(), wanted.len());
    let off = found.iter().zip(wanted).map(|(a, b)| (a - b).abs());
    assert!(off.fold(0.0, f32::max) < 2e-4, "{found:?} {wanted:?}");
}

#[test]
fn a_body_s_numbers_are_where_their_parts_say() {
    let seen = Observed::after_steps("stand");
    let (q, v) = (seen.q(), &seen.env.batch.worlds[0].state.v);
    near(&seen.of("root_height"), &q[2..3]);
    let velocity = seen.in_heading(Vec3::from_slice(v));
    near(&seen.of("root_velocity"), &velocity.to_array());
    let spin = seen.in_heading(quaternion(&q[3..]) * Vec3::from_slice(&v[3..]));
    near(&seen.of("root_angular_velocity"), &spin.to_array());
    near(&seen.of("left_knee"), &q[seen.joint("left_knee")..][..1]);
    let neck = quaternion(&q[seen.joint("neck")..]);
    near(
        &seen.of("neck"),
        &[neck * Vec3::X, neck * Vec3::Z]
            .map(|axis| axis.to_array())
            .concat(),
    );
    near(&seen.of("joint_velocities"), &v[6..]);
    let root = quaternion(&q[3..]);
    let axes = [Vec3::X, Vec3::Z].map(|axis| seen.in_heading(root * axis).to_array());
    near(&seen.of("root_rotation"), &axes.concat());
}

#[test]
fn a_task_s_numbers_are_where_their_parts_say() {
    let seen = Observed::after_steps("joystick");
    let target = Vec3::from_slice(&seen.q()[seen.joint("box")..]);
    let gap = (target - seen.root()).truncate();
    near(&seen.of("target_distance"), &[gap.length()]);
    near(&seen.of("target_height"), &[target.z]);
    let direction = seen.in_heading(gap.normalize().extend(0.0)).truncate();
    near(&seen.of("target_direction"), &direction.to_array());
    assert!((Vec2::from_slice(&seen.of("wanted_facing")).length() - 1.0).abs() < 1e-4);

    let seen = Observed::after_steps("box");
    let opponent = Vec3::from_slice(&seen.q()[seen.q().len() / 2..]);
    let gap = seen.in_heading(opponent - seen.root());
    near(&seen.of("opponent_position"), &gap.to_array());
    let centre = seen.in_heading(-seen.root());
    near(&seen.of("arena_centre"), &centre.to_array()[..2]);

    let seen = Observed::after_steps("track");
    assert!(Vec3::from_slice(&seen.of("reference_root_position")).length() < 1.0);
    near(
        &[seen.of("reference_joint_velocities").len() as f32],
        &[28.0],
    );
}

#[test]
fn maps_are_what_is_said_of_them() {
    let run = Files::new().run("obstacles");
    let (description, locomotion) = (description(&run), run.task.locomotion().unwrap());
    let maps = &description["inputs"][1]["maps"];
    let [rows, columns] = ["row_centres_m", "column_centres_m"].map(|key| floats(&maps[key]));
    let config = EnvConfig {
        task: locomotion.task,
        envs: 1,
        seed: 2,
        level: 9,
    };
    let env = CpuLocomotion::new(locomotion.matcher.clone(), &config);
    let ObservationSpec { vector, .. } = env.spec().observation;
    let observation = env.observation();
    let at = |field| env.field(field, 0);
    let heading = [at(state_f32::HEADING_X), at(state_f32::HEADING_Z)];
    let (mut shaded, edge) = (0, 0.375);
    assert!(maps["value"].as_str().unwrap().contains("depth / 0.375"));
    for (row, ahead) in rows.iter().enumerate() {
        for (column, left) in columns.iter().enumerate() {
            let [x, z] = to_world([*left, *ahead], heading);
            let point = [at(state_f32::X) + x, at(state_f32::Z) + z];
            let depth = (0..locomotion.task.obstacles()).map(|slot| {
                let [x, z, half_x, half_z] = env.obstacle(0, slot);
                (half_x - (point[0] - x).abs()).min(half_z - (point[1] - z).abs())
            });
            let depth = depth.fold(f32::MIN, f32::max);
            let wanted = (255.0 * (0.5 + depth / edge).clamp(0.0, 1.0) + 0.5).floor() / 255.0;
            let found = observation[vector + 2 * (row * columns.len() + column)];
            assert!((found - wanted).abs() < 1.5 / 255.0, "{found} {wanted}");
            shaded += usize::from(wanted > 0.5);
        }
    }
    assert!(shaded > 5);
}
