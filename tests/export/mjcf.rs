//! Models as MJCF files.

use super::cases::{Files, UntrainedRun};
use super::motion::KINDS;
use super::python;
use footwork::env::humanoid::action::action_scale;
use footwork::env::humanoid::task::characters;
use footwork::export::{FORMATS, export};
use footwork::kernels::humanoid::action_targets::set_targets;
use footwork::kernels::physics::proprioception::observe;
use footwork::physics::mjcf;
use footwork::physics::model::Model;
use footwork::physics::simulator::{SUBSTEPS, Simulator, SimulatorState, SolverOptions};
use footwork::physics::spatial::Spatial;
use std::ffi::OsStr;
use std::path::PathBuf;
use std::sync::Arc;

/// Where a model is after a second without a policy.
fn moved(model: &Model) -> Vec<f32> {
    let model = Arc::new(model.clone());
    let mut simulator = Simulator::new(model.clone(), SolverOptions::fast(&model));
    let mut state = SimulatorState::new(&model);
    let (targets, forces) = (
        vec![0.1; model.nu()],
        vec![Spatial::ZERO; model.bodies.len()],
    );
    for _ in 0..60 {
        simulator.step(&mut state, &targets, &forces);
    }
    state.q
}

#[test]
fn a_body_is_read_back_and_moves_as_before() {
    for run in &KINDS[1..] {
        let kind = &run.name;
        let path = run.kept("mjcf", "xml");
        let read = mjcf::read(&path, Default::default()).unwrap();
        assert!(read.notes.is_empty(), "{:?}", read.notes);
        let body = run.task.body().unwrap();
        let env = body.open(0);
        let (found, wanted) = (moved(&read.model), moved(env.task().model()));
        let away = found.iter().zip(&wanted).map(|(a, b)| (a - b).abs());
        let away = away.fold(0.0, f32::max);
        assert!(away < 1e-3, "{kind}: {away}");
    }
}

#[test]
fn mujoco_reads_a_body_as_what_was_exported() {
    let files = KINDS[1..].iter().map(|run| run.kept("mjcf", "mujoco.xml"));
    let files: Vec<PathBuf> = files.collect();
    let files: Vec<&OsStr> = files.iter().map(|file| file.as_os_str()).collect();
    python::run("tests/reference/exported_model.py", &files);
}

/// A policy that keeps about the pose in which a body stands, and heeds all that it observes.
fn attentive() -> UntrainedRun {
    let mut run = Files::new().run("stand");
    run.name = "stand-attentive".into();
    let rest = run.task.body().unwrap().open(0).task().rest_action();
    let policy = &mut run.checkpoint.policy;
    let last = policy.networks().actor.layers().last().unwrap();
    let (weights, biases) = (last.weights(), last.biases());
    let weights = &mut policy.parameters[weights];
    weights.iter_mut().for_each(|value| *value *= 0.08);
    policy.parameters[biases].copy_from_slice(&rest);
    run
}

/// Positions before each of some steps of the run's policy, from the model's own start.
fn played(run: &UntrainedRun, steps: usize) -> Vec<Vec<f32>> {
    let env = run.task.body().unwrap().open(0);
    let (model, policy) = (env.task().model().clone(), &run.checkpoint.policy);
    let mut simulator = Simulator::new(model.clone(), SolverOptions::fast(&model));
    let mut state = SimulatorState::new(&model);
    let (scale, characters) = (action_scale(&model), characters(&model));
    let mut observation = vec![0.0; policy.observation().dim()];
    let mut targets = vec![0.0; model.nu()];
    let forces = vec![Spatial::ZERO; model.bodies.len()];
    let step = |_| {
        let before = state.q.clone();
        simulator.kinematics(&state.q, &state.v);
        let (poses, velocities) = (&simulator.poses, &simulator.velocities);
        let own = &characters[1..];
        observe(
            &model,
            &state.q,
            &state.v,
            poses,
            velocities,
            own,
            &mut observation,
        );
        set_targets(&policy.mean(&observation), &scale, &mut targets);
        for _ in 0..SUBSTEPS {
            simulator.step(&mut state, &targets, &forces);
        }
        before
    };
    (0..steps).map(step).collect()
}

/// From the metadata of the one file and the numbers of the other alone.
#[test]
fn a_policy_moves_its_body_in_mujoco_as_here() {
    let run = attentive();
    let (policy, model) = (run.kept("onnx", "onnx"), run.kept("mjcf", "xml"));
    let film = model.with_extension("film");
    let [policy, model, film_path] = [&policy, &model, &film].map(|path| path.as_os_str());
    let words = ["--spread", "0", "--episodes", "1", "--film"].map(OsStr::new);
    let arguments = [&[policy, model], &words[..], &[film_path]].concat();
    python::run("tests/reference/exported.py", &arguments);
    let film = std::fs::read_to_string(&film).unwrap();
    let rows = film.lines().map(|line| {
        let numbers = line.split_whitespace().map(|number| number.parse::<f32>());
        numbers.collect::<Result<Vec<f32>, _>>().unwrap()
    });
    let steps = 10;
    for (step, (found, wanted)) in rows.zip(played(&run, steps)).enumerate() {
        let away = found.iter().zip(&wanted).map(|(a, b)| (a - b).abs());
        let away = away.fold(0.0, f32::max);
        assert!(away < 0.02, "step {step}: {away}");
    }
}

#[test]
fn motion_matching_has_no_model() {
    let format = FORMATS.iter().find(|format| format.name == "mjcf").unwrap();
    let error = export(&KINDS[0].trained(), format).unwrap_err().to_string();
    for part in ["simulated bodies", "plane", "onnx, safetensors, bvh, gltf"] {
        assert!(error.contains(part), "{error}");
    }
}
