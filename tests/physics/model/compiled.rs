//! Models as MuJoCo compiles them.

use super::parse;
use crate::golden;
use crate::mocap::recordings;
use footwork::physics::collision::PairKind;
use footwork::physics::humanoid::{BODIES, humanoid, punching_box};
use footwork::physics::mjcf::{self, MjcfOptions};
use footwork::physics::model::{Drive, GeomShape, JointKind, Model, SolverParams};
use footwork::physics::simulator::{Simulator, SimulatorState, SolverOptions};
use footwork::physics::spatial::Spatial;
use glam::{Mat3, Quat, Vec3};
use serde_json::Value;
use std::path::Path;
use std::sync::Arc;

/// Of the largest number beside it: single precision.
const CLOSE: f32 = 2e-6;

/// Of a looseness.
const LOOSE: f32 = 1e-3;

fn golden() -> Value {
    golden::json("model.json")
}

#[test]
fn our_humanoid_is_what_mujoco_makes_of_it() {
    compare("humanoid", &humanoid(), &golden()["humanoid"]["facts"]);
}

#[test]
fn random_models_are_what_mujoco_makes_of_them() {
    let golden = golden();
    let models = golden.as_object().unwrap();
    let random = models.iter().filter(|(name, _)| name.starts_with("random"));
    let mut compared = 0;
    for (name, model) in random {
        let read = parse(model["xml"].as_str().unwrap());
        let read = read.unwrap_or_else(|error| panic!("{name}: {error}"));
        compare(name, &read, &model["facts"]);
        compared += 1;
    }
    assert!(compared >= 2);
}

const PUBLIC: [&str; 3] = ["gym", "robot", "suite"];

/// A model of `tests/reference/models`, which have what public ones have.
fn public(name: &str) -> Model {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference/models");
    let path = folder.join(name).with_extension("xml");
    let read = mjcf::read(&path, MjcfOptions::default());
    read.unwrap_or_else(|error| panic!("{error}")).model
}

#[test]
fn models_like_public_ones_are_what_mujoco_makes_of_them() {
    let golden = golden();
    for name in PUBLIC {
        compare(name, &public(name), &golden[name]["facts"]);
    }
}

#[test]
fn models_that_are_written_are_still_what_mujoco_makes_of_them() {
    let golden = golden();
    let models = PUBLIC.map(|name| (name, public(name)));
    for (name, model) in models.into_iter().chain([("humanoid", humanoid())]) {
        let text = mjcf::to_text(&model).unwrap();
        let again = parse(&text).unwrap_or_else(|error| panic!("{name}: {error}\n{text}"));
        compare(name, &again, &golden[name]["facts"]);
    }
}

/// Springs, dampers, motors and general actuators, gears, limits of controls and torques.
#[test]
fn models_like_public_ones_move_as_in_mujoco() {
    let golden = golden();
    for name in PUBLIC {
        let mut model = public(name);
        model.pairs.clear();
        let model = Arc::new(model);
        let options = SolverOptions {
            dt: 1e-4,
            ..SolverOptions::converged(&model)
        };
        let mut simulator = Simulator::new(model.clone(), options);
        let mut state = SimulatorState::new(&model);
        let moved = &golden[name]["moved"];
        let still = vec![Spatial::ZERO; model.bodies.len()];
        for _ in 0..2000 {
            simulator.step(&mut state, &numbers(&moved["controls"]), &still);
        }
        for (what, found, bar) in [("q", &state.q, 1e-3), ("v", &state.v, 2e-2)] {
            let wanted = numbers(&moved[what]);
            let size = wanted
                .iter()
                .fold(1.0_f32, |most, value| most.max(value.abs()));
            for (index, (found, wanted)) in found.iter().zip(wanted).enumerate() {
                assert!(
                    (found - wanted).abs() < bar * size,
                    "{name}, {what} {index}: {found} instead of {wanted} (of {size})"
                );
            }
        }
    }
}

#[test]
fn motors_of_pd_engines_are_drives_where_that_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pendulum.xml");
    let text = |joint: &str, actuator: &str| {
        format!(
            r#"<mujoco><worldbody><body pos="0 0 1"><joint name="j" axis="0 1 0" {joint}/>
            <geom type="capsule" fromto="0 0 0 0 0 -.5" size=".04"/></body></worldbody>
            <actuator><{actuator} joint="j"/></actuator></mujoco>"#
        )
    };
    std::fs::write(
        &path,
        text(
            r#"stiffness="5" damping=".2""#,
            r#"motor gear="40" ctrlrange="-1 1""#,
        ),
    )
    .unwrap();
    let position = parse(&text("", r#"position kp="5" kv=".2" forcerange="-40 40""#)).unwrap();
    let as_drive = mjcf::read(&path, MjcfOptions { pd_motors: true }).unwrap();
    assert_eq!(
        (as_drive.model, as_drive.notes.len()),
        (position.clone(), 0)
    );
    let as_torque = mjcf::read(&path, MjcfOptions::default()).unwrap();
    let dof = &as_torque.model.dofs[0];
    assert_eq!(dof.spring.unwrap().stiffness, 5.0);
    assert_eq!(
        (dof.drive.unwrap().torque, dof.drive.unwrap().stiffness),
        (40.0, 0.0)
    );
    assert!(as_torque.notes[0].contains("--pd-motors"));
}

#[test]
fn the_reference_humanoid_is_read_and_its_motors_are_drives() {
    let Some(path) = recordings("humanoid/ase/amp_humanoid.xml") else {
        return;
    };
    let model = mjcf::read(&path, MjcfOptions { pd_motors: true })
        .unwrap()
        .model;
    let drive = |name: &str| {
        let joint = model.joints.iter().find(|joint| joint.name == name);
        model.dofs[joint.unwrap().v].drive.unwrap()
    };
    let expected = [
        ("abdomen_y", 1000.0, 100.0, 200.0),
        ("neck_z", 100.0, 10.0, 50.0),
        ("left_shoulder_x", 400.0, 40.0, 100.0),
        ("right_elbow", 300.0, 30.0, 70.0),
        ("right_hip_z", 500.0, 50.0, 200.0),
        ("left_knee", 500.0, 50.0, 150.0),
        ("left_ankle_z", 400.0, 40.0, 90.0),
    ];
    for (name, stiffness, damping, limit) in expected {
        let expected = Drive::to_target(stiffness, damping, limit);
        assert_eq!(drive(name), expected, "{name}");
    }
    assert_eq!((model.nu(), model.nv()), (28, 34));
    // To MuJoCo, motors are no drives to a position.
    let model = mjcf::read(&path, MjcfOptions::default()).unwrap().model;
    match golden().get("reference") {
        Some(golden) => compare("reference", &model, &golden["facts"]),
        None => println!("the reference's humanoid is compared with golden files made anew alone"),
    }
}

#[test]
fn our_humanoid_is_as_designed() {
    let model = humanoid();
    let names: Vec<&str> = model.bodies.iter().map(|body| body.name.as_str()).collect();
    assert_eq!(names, BODIES);
    assert_eq!((model.nv(), model.nu(), model.nq()), (34, 28, 43));
    let masses = [
        10.0, 12.0, 3.88, 1.5, 1.0, 0.5, 1.5, 1.0, 0.5, 4.5, 3.0, 1.0, 4.5, 3.0, 1.0,
    ];
    let found: Vec<f32> = model.bodies.iter().map(|body| body.mass).collect();
    close("masses", &found, &masses);
    let expected = [
        ("abdomen", [1000.0, 100.0, 200.0], 0.02),
        ("neck", [100.0, 10.0, 50.0], 0.01),
        ("shoulder", [400.0, 40.0, 100.0], 0.02),
        ("elbow", [300.0, 30.0, 70.0], 0.01),
        ("hip", [500.0, 50.0, 200.0], 0.02),
        ("knee", [500.0, 50.0, 150.0], 0.02),
        ("ankle", [400.0, 40.0, 90.0], 0.01),
    ];
    for dof in model.dofs.iter().skip(6) {
        let name = &model.joints[dof.joint].name;
        let (_, gains, armature) = expected
            .iter()
            .find(|(part, ..)| name.ends_with(part))
            .unwrap();
        let drive = dof.drive.unwrap();
        assert_eq!(
            [drive.stiffness, drive.damping, drive.limit],
            *gains,
            "{name}"
        );
        assert_eq!(dof.armature, *armature, "{name}");
    }
    assert!(
        model
            .geoms
            .iter()
            .all(|geom| geom.friction == 1.0 && !geom.frictionless)
    );
    // Both soles stand on the ground, or just above it.
    let height = model.qpos0[2] - 0.421546 - 0.40987 - 0.0225 - 0.0275;
    assert!((0.0..1e-3).contains(&height), "{height}");
}

#[test]
fn the_box_is_as_designed() {
    let model = punching_box();
    assert_eq!((model.bodies.len(), model.mass(), model.nv()), (1, 8.64, 6));
    let half = Vec3::new(0.2, 0.2, 0.9);
    assert_eq!(model.geoms[1].shape, GeomShape::Box { half });
    assert_eq!(
        (model.qpos0[2], model.pairs.as_slice()),
        (0.9, &[[0, 1]][..])
    );
}

/// All that a model says, with what MuJoCo says.
fn compare(name: &str, model: &Model, facts: &Value) {
    let told = |what: &str, index: usize| format!("{name}, {what} {index}");
    let list = |what: &str| facts[what].as_array().unwrap().clone();
    compare_start(name, model, &facts["start"]);
    assert_eq!(model.bodies.len(), list("bodies").len(), "{name}");
    for (index, fact) in list("bodies").iter().enumerate() {
        compare_body(&told("body", index), model, index, fact);
    }
    assert_eq!(model.joints.len(), list("joints").len(), "{name}");
    for (index, fact) in list("joints").iter().enumerate() {
        compare_joint(&told("joint", index), model, index, fact);
    }
    assert_eq!(model.dofs.len(), list("dofs").len(), "{name}");
    let mut row = 0;
    for (index, fact) in list("dofs").iter().enumerate() {
        compare_dof(&told("degree of freedom", index), model, index, fact);
        assert_eq!(model.dofs[index].row, row);
        row += model.dofs[index].depth;
    }
    assert_eq!(model.geoms.len(), list("geoms").len(), "{name}");
    for (index, fact) in list("geoms").iter().enumerate() {
        compare_geom(&told("geom", index), model, index, fact);
    }
    compare_pairs(name, model, &list("pairs"));
    compare_trees(model);
}

fn compare_start(name: &str, model: &Model, fact: &Value) {
    let fact = fact.as_array().unwrap();
    assert_eq!(model.qpos0.len(), fact.len(), "{name}");
    for joint in &model.joints {
        let positions = joint.q..joint.q + joint.kind.nq();
        let (q, fact) = (&model.qpos0[positions.clone()], &fact[positions]);
        match joint.kind {
            JointKind::Free => {
                let rotation = Quat::from_xyzw(q[4], q[5], q[6], q[3]);
                pose(name, Vec3::from_slice(q), rotation, &fact.into());
            }
            _ => close(name, q, &numbers(&fact.into())),
        }
    }
}

fn compare_body(told: &str, model: &Model, index: usize, fact: &Value) {
    let body = &model.bodies[index];
    assert_eq!(body.name, fact["name"], "{told}");
    assert_eq!(body.parent, optional(&fact["parent"]), "{told}");
    pose(told, body.position, body.rotation, &fact["pose"]);
    close(told, &[body.mass], &[number(&fact["mass"])]);
    close(told, &body.com.to_array(), &numbers(&fact["com"]));
    close(told, &symmetric(&body.inertia), &numbers(&fact["inertia"]));
    assert!(
        alike(body.invweight0, &fact["invweight0"]),
        "{told}: {}",
        body.invweight0
    );
    assert!(
        model.joints[body.joints.clone()]
            .iter()
            .all(|joint| joint.body == index)
    );
    assert!(
        model.dofs[body.dofs.clone()]
            .iter()
            .all(|dof| dof.body == index)
    );
    let own = body.dofs.clone().next_back();
    let above = body.parent.and_then(|parent| model.bodies[parent].last_dof);
    assert_eq!(body.last_dof, own.or(above), "{told}");
}

fn compare_joint(told: &str, model: &Model, index: usize, fact: &Value) {
    let joint = &model.joints[index];
    let kind = match joint.kind {
        JointKind::Free => "free",
        JointKind::Ball => "ball",
        JointKind::Hinge => "hinge",
    };
    assert_eq!(
        (joint.name.as_str(), kind),
        (text(&fact["name"]), text(&fact["kind"]))
    );
    assert_eq!(joint.body, optional(&fact["body"]).unwrap(), "{told}");
    assert_eq!(joint.q, optional(&fact["q"]).unwrap(), "{told}");
    assert_eq!(joint.v, optional(&fact["v"]).unwrap(), "{told}");
    if joint.kind == JointKind::Free {
        return;
    }
    close(
        told,
        &joint.position.to_array(),
        &numbers(&fact["position"]),
    );
    close(
        told,
        &solver_params(&joint.solver_params),
        &numbers(&fact["solver_params"]),
    );
    let range = fact["range"].as_array().map(|_| numbers(&fact["range"]));
    assert_eq!(joint.range.is_some(), range.is_some(), "{told}");
    close(
        told,
        &joint.range.unwrap_or_default(),
        &range.unwrap_or(vec![0.0; 2]),
    );
    if joint.kind == JointKind::Hinge {
        close(told, &joint.axis.to_array(), &numbers(&fact["axis"]));
    }
}

fn compare_dof(told: &str, model: &Model, index: usize, fact: &Value) {
    let dof = &model.dofs[index];
    assert_eq!(Some(dof.body), optional(&fact["body"]), "{told}");
    assert_eq!(dof.parent, optional(&fact["parent"]), "{told}");
    let way = std::iter::successors(Some(index), |&dof| model.dofs[dof].parent);
    assert_eq!(dof.depth, way.count(), "{told}");
    close(told, &[dof.armature], &[number(&fact["armature"])]);
    assert!(
        alike(dof.invweight0, &fact["invweight0"]),
        "{told}: {}",
        dof.invweight0
    );
    let joint = &model.joints[dof.joint];
    assert!(
        (joint.v..joint.v + joint.kind.nv()).contains(&index),
        "{told}"
    );
    let spring = fact["spring"].as_array().map(|_| numbers(&fact["spring"]));
    assert_eq!(dof.spring.is_some(), spring.is_some(), "{told}");
    if let (Some(found), Some(wanted)) = (dof.spring, spring) {
        close(told, &[found.stiffness, found.damping, found.rest], &wanted);
    }
    let drive = Some(&fact["drive"]).filter(|drive| drive.is_object());
    assert_eq!(dof.drive.is_some(), drive.is_some(), "{told}");
    if let (Some(found), Some(wanted)) = (dof.drive, drive) {
        close(
            told,
            &[found.stiffness, found.damping],
            &numbers(&wanted["gains"]),
        );
        close(told, &[found.torque], &[number(&wanted["torque"])]);
        let limit = wanted["limit"].as_f64();
        assert_eq!(
            found.limit,
            limit.map_or(f32::MAX, |limit| limit as f32),
            "{told}"
        );
        let control = wanted["control"]
            .as_array()
            .map(|_| numbers(&wanted["control"]));
        close(
            told,
            &found.control,
            &control.unwrap_or(vec![f32::MIN, f32::MAX]),
        );
    }
}

fn compare_geom(told: &str, model: &Model, index: usize, fact: &Value) {
    let geom = &model.geoms[index];
    let (shape, size) = match geom.shape {
        GeomShape::Plane => ("plane", vec![]),
        GeomShape::Sphere { radius } => ("sphere", vec![radius]),
        GeomShape::Capsule { radius, half } => ("capsule", vec![radius, half]),
        GeomShape::Box { half } => ("box", half.to_array().to_vec()),
    };
    assert_eq!(
        (geom.name.as_str(), shape),
        (text(&fact["name"]), text(&fact["shape"]))
    );
    assert_eq!(geom.body, optional(&fact["body"]), "{told}");
    close(told, &size, &numbers(&fact["size"]));
    pose(told, geom.position, geom.rotation, &fact["pose"]);
    close(told, &[geom.friction], &[number(&fact["friction"])]);
    assert_eq!(geom.frictionless, fact["frictionless"], "{told}");
    close(
        told,
        &solver_params(&geom.solver_params),
        &numbers(&fact["solver_params"]),
    );
}

/// The same pairs, family after family, in each pair the simpler shape first.
fn compare_pairs(name: &str, model: &Model, facts: &[Value]) {
    let mut found = model.pairs.clone();
    let shapes = |pair: &[usize; 2]| pair.map(|geom| model.geoms[geom].shape);
    assert!(
        found.is_sorted_by_key(|pair| PairKind::of(shapes(pair))),
        "{name}"
    );
    let rank = |geom: usize| match model.geoms[geom].shape {
        GeomShape::Plane => 0,
        GeomShape::Sphere { .. } => 1,
        GeomShape::Capsule { .. } => 2,
        GeomShape::Box { .. } => 3,
    };
    assert!(found.iter().all(|&[a, b]| rank(a) <= rank(b)), "{name}");
    found.iter_mut().for_each(|pair| pair.sort());
    found.sort();
    let wanted: Vec<[usize; 2]> = (facts.iter())
        .map(|pair| [0, 1].map(|k| optional(&pair[k]).unwrap()))
        .collect();
    assert_eq!(found, wanted, "{name}");
}

/// Trees hold all bodies and degrees of freedom, one after the other.
fn compare_trees(model: &Model) {
    let (mut bodies, mut dofs) = (0, 0);
    for (index, tree) in model.trees.iter().enumerate() {
        assert_eq!((tree.bodies.start, tree.dofs.start), (bodies, dofs));
        (bodies, dofs) = (tree.bodies.end, tree.dofs.end);
        let own = &model.bodies[tree.bodies.clone()];
        assert!(own.iter().all(|body| body.tree == index));
        assert!(own[0].parent.is_none() && own[1..].iter().all(|body| body.parent.is_some()));
        assert!(
            model.dofs[tree.dofs.clone()]
                .iter()
                .all(|dof| tree.bodies.contains(&dof.body))
        );
    }
    assert_eq!((bodies, dofs), (model.bodies.len(), model.dofs.len()));
}

fn pose(told: &str, position: Vec3, rotation: Quat, fact: &Value) {
    let fact = numbers(fact);
    close(told, &position.to_array(), &fact[..3]);
    let wanted = Quat::from_xyzw(fact[4], fact[5], fact[6], fact[3]);
    // A quaternion and its opposite are the same turn.
    let wanted = if rotation.dot(wanted) < 0.0 {
        -wanted
    } else {
        wanted
    };
    close(told, &rotation.to_array(), &wanted.to_array());
}

fn close(told: &str, found: &[f32], wanted: &[f32]) {
    assert_eq!(found.len(), wanted.len(), "{told}: {found:?} {wanted:?}");
    let size = wanted
        .iter()
        .fold(f32::MIN_POSITIVE, |size, w| size.max(w.abs()));
    let near = |(a, b): (&f32, &f32)| (a - b).abs() <= CLOSE * size;
    assert!(
        found.iter().zip(wanted).all(near),
        "{told}: {found:?} {wanted:?}"
    );
}

/// Looseness is what is left after a long calculation in single precision.
fn alike(found: f32, wanted: &Value) -> bool {
    let wanted = number(wanted);
    (found - wanted).abs() <= LOOSE * wanted
}

fn symmetric(matrix: &Mat3) -> [f32; 9] {
    assert!(
        (*matrix - matrix.transpose())
            .to_cols_array()
            .iter()
            .all(|off| off.abs() < 1e-6)
    );
    matrix.to_cols_array()
}

fn solver_params(params: &SolverParams) -> Vec<f32> {
    [&params.solref[..], &params.solimp].concat()
}

fn number(value: &Value) -> f32 {
    value.as_f64().unwrap() as f32
}

fn numbers(value: &Value) -> Vec<f32> {
    value.as_array().unwrap().iter().map(number).collect()
}

fn optional(value: &Value) -> Option<usize> {
    value.as_u64().map(|number| number as usize)
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap()
}
