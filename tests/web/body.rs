//! The page of a simulated body.

use footwork::nn::{ActorCritic, Policy};
use footwork::physics::motion_library::MotionLibrary;
use footwork::physics::scenes;
use footwork::train::config::{Config, Preset};
use footwork::train::tasks;
use footwork::web::Page;
use footwork::web::folder::RunFiles;
use footwork::web::run_file::{Played, RunFile};
use std::sync::Arc;

/// The files of an untrained policy of a task.
fn files(task: &str) -> (RunFiles, Config) {
    let entry = tasks::find(task).expect("a task");
    let config = entry.config(Preset::Fast);
    let spec = entry.check(&config).expect("a preset");
    let network = &config.ppo.network;
    let policy = Policy::new(network, &spec.observation, spec.action, 1).expect("a network");
    let loaded = (entry.load)(&config).expect("synthetic recordings").task;
    let body = loaded.body().expect("a body");
    let files = RunFiles::of_body(task, 1, &policy, &config, &body).expect("files");
    (files, config)
}

#[test]
fn every_task_of_a_body_is_played() {
    for task in [
        "stand", "imitate", "track", "punch", "joystick", "skills", "box",
    ] {
        let mut page = Page::open(files(task).0.run()).expect(task);
        assert_eq!(page.task, task);
        for _ in 0..30 {
            page.advance(1.0 / 60.0).expect(task);
        }
        let state = page.state();
        assert!(state.frames_shown >= 14, "{task}: {state:?}");
        assert!(state.height > 0.1, "{task}: {state:?}");
        let scene = page.picture(1.6).scene;
        let finite =
            |capsule: &footwork::view::scene::Capsule| capsule.a.iter().all(|x| x.is_finite());
        assert!(
            scene.capsules.len() > 10 && scene.capsules.iter().all(finite),
            "{task}"
        );
        let has_target = ["punch", "joystick"].contains(&task);
        page.press([0.5, -0.8]);
        page.release().expect(task);
        let moved = page.state().target != state.target;
        assert_eq!(moved, has_target, "{task}: a click puts the box elsewhere");
    }
}

#[test]
fn a_pointer_that_holds_a_body_pushes_it() {
    let (files, _) = files("stand");
    let play = |push: bool| {
        let mut page = Page::open(files.run()).expect("a run");
        page.picture(1.6);
        page.advance(1.0 / 30.0).expect("a frame");
        if push {
            page.press([0.0, 0.05]);
            page.drag([0.4, 0.05]);
        }
        for _ in 0..6 {
            page.advance(1.0 / 30.0).expect("a frame");
        }
        page.state().at
    };
    let [free, pushed] = [play(false), play(true)];
    let far = (free[0] - pushed[0]).hypot(free[1] - pushed[1]);
    assert!(far > 0.02, "{far} m");
}

#[test]
fn recordings_are_carried_with_their_weights_and_kinds() {
    let (files, config) = files("skills");
    let RunFile { played, .. } = RunFile::from_bytes(files.run()).expect("a run");
    let Played::Body {
        recordings: Some(recordings),
        ..
    } = played
    else {
        panic!("skills are recorded");
    };
    let model = Arc::new(scenes::humanoid());
    let carried = recordings.library(&model).expect("a library");
    let entry = tasks::find("skills").expect("a task");
    let body = (entry.load)(&config).expect("recordings").task.body();
    let original: Arc<MotionLibrary> = body.and_then(|body| body.recordings).expect("recordings");
    assert_eq!(carried.motions().len(), original.motions().len());
    for number in 0..original.motions().len() {
        let [ours, theirs] = [&carried, &*original].map(|library| &library.motions()[number]);
        assert_eq!((&ours.name, ours.frames), (&theirs.name, theirs.frames));
        assert_eq!(carried.kind(number), original.kind(number));
        assert!((carried.share(number) - original.share(number)).abs() < 1e-6);
        let pairs = ours.q.iter().zip(&theirs.q);
        let off = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(off < 5e-4, "{}: {off}", ours.name);
    }
}

#[test]
fn the_actor_is_carried_whole_and_the_critic_is_not() {
    let (_, config) = files("stand");
    let spec = tasks::find("stand")
        .expect("a task")
        .check(&config)
        .expect("a preset");
    let network = &config.ppo.network;
    let mut policy = Policy::new(network, &spec.observation, spec.action, 1).expect("a network");
    let networks = ActorCritic::new(network, &spec.observation, spec.action, 1).expect("networks");
    let weights = policy.parameters.iter_mut().enumerate();
    weights.for_each(|(at, weight)| *weight = ((at * 37 % 101) as f32 - 50.0) / 500.0);
    let file = RunFile {
        task: "stand".into(),
        steps: 1,
        policy: policy.clone(),
        played: Played::Body {
            config: Box::new(config),
            recordings: None,
        },
    };
    let bytes = file.to_bytes().expect("a file");
    assert!(bytes.len() < 4 * networks.actor.span().len() + 20_000);
    let carried = RunFile::from_bytes(&bytes).expect("a run").policy;
    let observation: Vec<f32> = (0..spec.observation.dim())
        .map(|i| (i as f32).sin())
        .collect();
    assert_eq!(policy.mean(&observation), carried.mean(&observation));
    let damaged = RunFile::from_bytes(&bytes[..bytes.len() - 4]).err();
    let damaged = damaged.expect("it is cut off").to_string();
    assert!(damaged.contains("run.footwork is damaged"), "{damaged}");
}
