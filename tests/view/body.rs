//! Simulated bodies in a window, used as a person would, and in crowds.

use crate::compare::place;
use crate::{Picture, gpu};
use eframe::egui::{Event, Modifiers, PointerButton, Pos2, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use egui_kittest::wgpu::{WgpuTestRenderer, create_render_state};
use footwork::env::live_view::LiveView;
use footwork::env::{EnvBatch, Transition};
use footwork::gpu::{Array, Device};
use footwork::physics::scenes;
use footwork::ranks::Ranks;
use footwork::train::body_policy::BodyPolicy;
use footwork::train::checkpoint::{Checkpoint, Header};
use footwork::train::config::{Config, Preset};
use footwork::train::state::TrainerState;
use footwork::train::task::Task;
use footwork::train::tasks::find;
use footwork::view::body_playthrough::{BodyContext, BodyPlaythrough, BodyPush};
use footwork::view::shapes::{self, Look, seen};
use footwork::view::{BodyCrowd, Camera, Renderer, Scene};
use footwork::viewer::BodyViewer;
use footwork::viewer::policies::{LoadedPolicy, Policies, PolicyEntry};
use footwork::viewer::window::shared;
use glam::Vec3;

/// A task with few environments, on the performer's motion.
pub fn task(name: &str) -> (Config, Box<dyn Task>) {
    let entry = find(name).unwrap();
    let mut config = entry.config(Preset::Fast);
    config.ppo.envs = 4;
    let task = (entry.load)(&config).unwrap().task;
    (config, task)
}

/// What has learned nothing: it keeps the pose that the task rests in.
pub fn untrained(config: &Config, task: &dyn Task) -> BodyPolicy {
    BodyPolicy::new(checkpoint(config, task, 0), config, task).unwrap()
}

/// A checkpoint of what has learned nothing in so many steps.
pub fn checkpoint(config: &Config, task: &dyn Task, steps: u64) -> Checkpoint {
    let envs = task
        .open(&Device::Cpu, &Ranks::alone(), config.ppo.envs, 1)
        .unwrap();
    let learner = task.learner(config, &envs, &Device::Cpu).unwrap();
    let header = Header {
        version: "test".into(),
        task: config.task.name.clone(),
        spec: envs.spec(),
        fingerprint: task.fingerprint(),
        config: config.to_toml(),
        steps,
    };
    Checkpoint::take(header, &*learner, &envs, &TrainerState::default()).unwrap()
}

pub fn open(name: &str) -> Harness<'static, BodyViewer> {
    let (config, task) = task(name);
    let context = BodyContext::new(task.body().unwrap());
    let untrained = PolicyEntry {
        name: "untrained".into(),
        load: Box::new(move || {
            Ok(LoadedPolicy {
                policy: untrained(&config, &*task),
                steps: 0,
            })
        }),
    };
    window(context, Policies::new(vec![untrained]))
}

/// A window on these policies.
pub fn window(
    context: BodyContext,
    policies: Policies<BodyPolicy>,
) -> Harness<'static, BodyViewer> {
    let gpu = gpu();
    let window = create_render_state(shared(&gpu), Default::default());
    let viewer = BodyViewer::new(&gpu, &window, context, policies).unwrap();
    let renderer = WgpuTestRenderer::from_render_state(window);
    let mut harness = Harness::builder()
        .with_size(Vec2::new(900.0, 560.0))
        .with_step_dt(1.0 / 30.0)
        .renderer(renderer)
        .build_ui_state(|ui, viewer: &mut BodyViewer| viewer.show(ui), viewer);
    harness.run_steps(6);
    harness
}

pub fn press(harness: &mut Harness<BodyViewer>, name: &str) {
    harness.get_by_label(name).click();
    harness.run_steps(3);
}

pub fn pointer(harness: &mut Harness<BodyViewer>, pos: Pos2, pressed: bool) {
    harness.event(Event::PointerMoved(pos));
    harness.event(Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    });
    harness.step();
}

/// Keeps what the window shows, for a look.
pub fn keep(harness: &mut Harness<BodyViewer>, name: &str) -> Picture {
    let drawn = harness.render().expect("a picture");
    let picture = Picture {
        size: [drawn.width(), drawn.height()],
        rgb: drawn
            .pixels()
            .flat_map(|pixel| pixel.0[..3].to_vec())
            .collect(),
    };
    picture.save(&place(&format!("{name}.png")));
    picture
}

#[test]
fn a_body_is_played_step_by_step_and_rewound() {
    let mut harness = open("stand");
    let at = |harness: &Harness<BodyViewer>| harness.state().timeline().at();
    let playing = at(&harness);
    harness.run_steps(3);
    assert!(at(&harness) > playing);
    press(&mut harness, "Pause");
    let paused = at(&harness);
    let moment = |harness: &Harness<BodyViewer>| harness.state().timeline().now().q.clone();
    let before = moment(&harness);
    press(&mut harness, "Step");
    press(&mut harness, "Step");
    assert_eq!(at(&harness), paused + 2);
    let after = moment(&harness);
    assert_ne!(before, after);
    press(&mut harness, "Back");
    press(&mut harness, "Back");
    assert_eq!(moment(&harness), before);
    press(&mut harness, "Next episode");
    assert_eq!(harness.state().timeline().now().episode, 1);
    keep(&mut harness, "body-stand");
}

#[test]
fn what_a_moment_leads_to_is_the_same_every_time() {
    for name in ["stand", "punch", "box"] {
        let (config, task) = task(name);
        let policy = untrained(&config, &*task);
        let mut context = BodyContext::new(task.body().unwrap());
        let mut played = vec![BodyPlaythrough::new(&mut context, 2).unwrap()];
        // So far that it falls, and the next episode begins.
        for step in 0..90 {
            played.push(played[step].next(&mut context, &policy, None).unwrap());
        }
        assert_eq!(played[0].episode, 2);
        assert!(played[90].episode > 2, "{name}: nothing balances it");
        for from in [0, 10, 89] {
            let again = played[from].next(&mut context, &policy, None).unwrap();
            assert_eq!(again.q, played[from + 1].q, "{name} {from}");
        }
    }
}

#[test]
fn a_bout_is_watched() {
    let mut harness = open("box");
    harness.run_steps(6);
    press(&mut harness, "Pause");
    let moment = harness.state().timeline().now();
    assert!(moment.steps > 0 && moment.style.is_some());
    keep(&mut harness, "body-box");
}

#[test]
fn a_push_goes_where_it_is_meant_to() {
    let (config, task) = task("stand");
    let policy = untrained(&config, &*task);
    let mut context = BodyContext::new(task.body().unwrap());
    let first = BodyPlaythrough::new(&mut context, 0).unwrap();
    // The task's own pushes are on the torso.
    let torso = context.model().body("torso").unwrap();
    let mut pushed = |force: Vec3| {
        let push = Some(BodyPush { body: torso, force });
        let mut moment = first.clone();
        for _ in 0..6 {
            moment = moment.next(&mut context, &policy, push).unwrap();
        }
        assert_eq!(moment.push, push);
        Vec3::from_slice(&moment.q)
    };
    let (left, right) = (pushed(Vec3::Y * 300.0), pushed(Vec3::Y * -300.0));
    assert!(left.y - right.y > 0.05, "{left} {right}");
    // The ground carries it.
    let mut stands = first;
    for _ in 0..6 {
        stands = stands.next(&mut context, &policy, None).unwrap();
    }
    let up: f32 = stands.touching.iter().map(|touch| touch.force.z).sum();
    assert!(up > 100.0, "{up}");
}

#[test]
fn a_body_that_is_dragged_is_pushed() {
    let mut harness = open("imitate");
    press(&mut harness, "Pause");
    // The camera looks at it.
    let body = Pos2::new(310.0, 265.0);
    pointer(&mut harness, body, true);
    for step in 1..=6 {
        harness.event(Event::PointerMoved(
            body - Vec2::new(18.0 * step as f32, 0.0),
        ));
        harness.step();
    }
    harness.key_press(eframe::egui::Key::ArrowRight);
    harness.run_steps(2);
    let push = harness.state().timeline().now().push.expect("a push");
    assert!(push.force.length() > 50.0, "{push:?}");
    keep(&mut harness, "body-pushed");
    pointer(&mut harness, body - Vec2::new(108.0, 0.0), false);
    press(&mut harness, "Step");
    assert_eq!(harness.state().timeline().now().push, None);
}

#[test]
fn what_a_body_is_to_move_like_is_shown_beside_it() {
    let mut harness = open("imitate");
    press(&mut harness, "Pause");
    harness.get_by_label_contains("style reward");
    harness.get_by_label_contains("most like");
    let now = harness.state().timeline().now();
    assert!(now.style.is_some() && now.reference.is_some());
    let with = keep(&mut harness, "body-imitate");
    press(&mut harness, "Recording");
    let without = keep(&mut harness, "body-imitate-alone");
    assert!(with.difference(&without).0 > 0.005);
    press(&mut harness, "Contact forces");
    let bare = keep(&mut harness, "body-imitate-bare");
    assert!(without.difference(&bare).0 > 0.0);
}

#[test]
fn a_click_moves_the_box() {
    let mut harness = open("punch");
    press(&mut harness, "Pause");
    let model = scenes::humanoid_and_box();
    let target = &model.bodies[model.body("box").unwrap()];
    let first = model.joints[target.joints.start].q;
    let at = |harness: &Harness<BodyViewer>| {
        Vec3::from_slice(&harness.state().timeline().now().q[first..])
    };
    let before = at(&harness);
    let ground = Pos2::new(420.0, 380.0);
    pointer(&mut harness, ground, true);
    pointer(&mut harness, ground, false);
    harness.run_steps(2);
    let (after, root) = (at(&harness), harness.state().timeline().now().q.clone());
    assert_ne!(before, after);
    assert!((after - Vec3::from_slice(&root)).length() < 4.0, "{after}");
    keep(&mut harness, "body-punch");
    press(&mut harness, "Step");
    assert!((at(&harness) - after).length() < 0.02);
}

/// Plays a step whose action is zero.
fn step(batch: &mut EnvBatch, device: &Device) {
    let spec = batch.spec();
    let out = Transition {
        step: 0,
        reward: &mut Array::zeroed(device, 1),
        style_reward: &mut Array::zeroed(device, 1),
        termination: &mut Array::zeroed(device, 1),
        group: &mut Array::zeroed(device, 1),
        final_observation: &mut Array::zeroed(device, spec.observation.dim()),
    };
    batch.parts[0].step(&Array::zeroed(device, spec.action), 0, out);
    // A GPU has poses of what is observed.
    batch.parts[0].observe(&mut Array::zeroed(device, spec.observation.dim()), 0);
}

/// A crowd of one must look like its only body, wherever its state is kept.
fn one_of_a_crowd(device: Device) {
    let (_, task) = task("punch");
    let mut batch = task.open(&device, &Ranks::alone(), 1, 5).unwrap();
    let Some(LiveView::Bodies(view)) = batch.live_view().unwrap() else {
        panic!("bodies");
    };
    let mut renderer = Renderer::new(&gpu());
    let model = view.model.clone();
    let crowd = BodyCrowd::new(&renderer, view);
    let state = |batch: &EnvBatch| -> Vec<f32> {
        let mut section = Default::default();
        batch.parts[0].save(&mut section).unwrap();
        section
            .take_array("state", model.nq() + model.nv())
            .unwrap()
    };
    let start = state(&batch);
    for _ in 0..3 {
        step(&mut batch, &device);
    }
    let poses = shapes::poses(&model, &state(&batch));
    let aside = -seen(Vec3::new(start[0], start[1], 0.0));
    let mut scene = Scene::default();
    shapes::draw(&mut scene, &model, &poses, aside, Look::Solid);
    let camera = Camera::default();
    let size = [240, 160];
    let alone = Picture::with(&mut renderer, &scene, None, &camera, size);
    let crowd = Picture::with(
        &mut renderer,
        &Scene::default(),
        Some(&crowd),
        &camera,
        size,
    );
    let empty = Picture::with(&mut renderer, &Scene::default(), None, &camera, size);
    // The crowd's capsules have fewer corners.
    let (far, _) = alone.difference(&crowd);
    assert!(far < 0.01, "{far}");
    let (far, _) = alone.difference(&empty);
    assert!(far > 0.03, "{far}");
}

#[test]
fn bodies_are_drawn_from_where_they_are_kept() {
    one_of_a_crowd(Device::from(gpu()));
    one_of_a_crowd(Device::Cpu);
}
