//! Windows on trainings that go on: each new checkpoint is shown, a damaged one is not.

use crate::{MATCHER, body, viewer};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use footwork::env::locomotion::EnvConfig;
use footwork::gpu::Device;
use footwork::rl::ppo::{Ppo, PpoLearner};
use footwork::train::body_policy::BodyPolicy;
use footwork::train::checkpoint::{Checkpoint, Header};
use footwork::train::controller::Controller;
use footwork::train::fingerprint::Fingerprint;
use footwork::train::state::TrainerState;
use footwork::view::body_playthrough::BodyContext;
use footwork::viewer::policies::{LoadedPolicy, Policies, PolicyEntry};
use std::path::PathBuf;

/// Frames of half a second and a bit: as long as it takes until the file is looked at again.
const LOOK: usize = 17;

fn entry<P: 'static>(
    name: &str,
    path: PathBuf,
    load: impl Fn(Checkpoint) -> P + 'static,
) -> PolicyEntry<P> {
    let load = move || {
        let checkpoint = Checkpoint::load(&path)?;
        Ok(LoadedPolicy {
            steps: checkpoint.header.steps,
            policy: load(checkpoint),
        })
    };
    PolicyEntry {
        name: name.into(),
        load: Box::new(load),
    }
}

/// A checkpoint on the plane of what has learned nothing in so many steps.
fn checkpoint(steps: u64) -> Checkpoint {
    let ppo = Ppo {
        envs: 4,
        ..Ppo::default()
    };
    let config = EnvConfig {
        task: viewer::plane(),
        envs: ppo.envs,
        seed: 1,
        level: 0,
    };
    let envs = config.open(&Device::Cpu, &MATCHER).unwrap();
    let learner = PpoLearner::new(&ppo, &envs, &Device::Cpu, steps as u32).unwrap();
    let header = Header {
        version: "test".into(),
        task: "plane".into(),
        spec: envs.spec(),
        fingerprint: Fingerprint::from(MATCHER.database.fingerprint),
        config: String::new(),
        steps,
    };
    Checkpoint::take(header, &learner, &envs, &TrainerState::default()).unwrap()
}

fn steps_are<S>(harness: &Harness<S>, steps: u64) {
    harness.get_by_label(&format!("learned from {steps} steps"));
}

#[test]
fn each_new_checkpoint_is_shown() {
    let folder = tempfile::tempdir().unwrap();
    let [first, last] = ["steps-50.ckpt", "last.ckpt"].map(|name| folder.path().join(name));
    checkpoint(50).save(&first).unwrap();
    checkpoint(100).save(&last).unwrap();
    let load = |of: Checkpoint| Box::new(of.policy) as Box<dyn Controller>;
    let entries = vec![
        entry("first", first, load),
        entry("last", last.clone(), load),
    ];
    let policies = Policies::new(entries).following(last.clone());
    let mut harness = viewer::window(viewer::plane(), policies);
    steps_are(&harness, 100);
    let at = harness.state().timeline().at();

    checkpoint(200).save(&last).unwrap();
    harness.run_steps(LOOK);
    steps_are(&harness, 200);
    // The character goes on from where it is.
    assert!(harness.state().timeline().at() > at + 10);

    // Half a file, as somebody leaves it who copies a run from elsewhere.
    let whole = std::fs::read(&last).unwrap();
    std::fs::write(&last, &whole[..whole.len() / 2]).unwrap();
    harness.run_steps(LOOK);
    harness.get_by_label_contains("newest checkpoint cannot be read");
    steps_are(&harness, 200);
    let at = harness.state().timeline().at();
    harness.run_steps(10);
    assert!(harness.state().timeline().at() > at);

    checkpoint(300).save(&last).unwrap();
    harness.run_steps(LOOK);
    steps_are(&harness, 300);
    let complaint = harness.query_by_label_contains("newest checkpoint cannot be read");
    assert!(complaint.is_none());

    // Who chooses a policy looks at that one.
    harness.get_by_value("last").click();
    harness.run_steps(3);
    harness.get_by_label("first").click();
    harness.run_steps(3);
    steps_are(&harness, 50);
    checkpoint(400).save(&last).unwrap();
    harness.run_steps(LOOK);
    steps_are(&harness, 50);
    harness.get_by_label("Follow the training").click();
    harness.run_steps(3);
    steps_are(&harness, 400);
}

#[test]
fn a_body_goes_on_under_the_newest_checkpoint() {
    let folder = tempfile::tempdir().unwrap();
    let last = folder.path().join("last.ckpt");
    let (config, task) = body::task("stand");
    let save = |steps: u64| {
        let checkpoint = body::checkpoint(&config, &*task, steps);
        checkpoint.save(&last).unwrap();
    };
    save(100);
    let load = {
        let (config, task) = body::task("stand");
        move |of: Checkpoint| BodyPolicy::new(of, &config, &*task).unwrap()
    };
    let policies = Policies::new(vec![entry("last", last.clone(), load)]);
    let policies = policies.following(last.clone());
    let mut harness = body::window(BodyContext::new(task.body().unwrap()), policies);
    steps_are(&harness, 100);
    let before = harness.state().timeline().len();
    save(200);
    harness.run_steps(LOOK);
    steps_are(&harness, 200);
    assert!(harness.state().timeline().len() > before);
    std::fs::write(&last, "no checkpoint").unwrap();
    harness.run_steps(LOOK);
    harness.get_by_label_contains("newest checkpoint cannot be read");
    steps_are(&harness, 200);
}
