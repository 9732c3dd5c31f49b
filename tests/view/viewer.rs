//! The window's contents, used as a person would.

use crate::{DATABASE, Walker, context, gpu};
use eframe::egui::{Event, Key, Modifiers, PointerButton, Pos2, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use egui_kittest::wgpu::{WgpuTestRenderer, create_render_state};
use footwork::env::locomotion::{LocomotionTask, Obstacles, Plane};
use footwork::kernels::termination;
use footwork::motion::features::FRAMES_PER_STEP;
use footwork::train::controller::Controller;
use footwork::train::playthrough::Playthrough;
use footwork::viewer::Viewer;
use footwork::viewer::policies::PolicyEntry;
use footwork::viewer::window::shared;

fn plane() -> LocomotionTask {
    LocomotionTask::Plane(Plane::default())
}
/// A point of the ground in front of the character.
const GROUND: Pos2 = Pos2::new(250.0, 430.0);

fn walker() -> PolicyEntry<Box<dyn Controller>> {
    PolicyEntry {
        name: "walker".into(),
        load: Box::new(|| Ok(Box::new(Walker))),
    }
}

fn broken() -> PolicyEntry<Box<dyn Controller>> {
    PolicyEntry {
        name: "broken".into(),
        load: Box::new(|| anyhow::bail!("this checkpoint is damaged")),
    }
}

fn open(
    task: LocomotionTask,
    policies: Vec<PolicyEntry<Box<dyn Controller>>>,
) -> Harness<'static, Viewer> {
    let gpu = gpu();
    let window = create_render_state(shared(&gpu), Default::default());
    let viewer = Viewer::new(&gpu, &window, context(task), policies).unwrap();
    let renderer = WgpuTestRenderer::from_render_state(window);
    let mut harness = Harness::builder()
        .with_size(Vec2::new(900.0, 560.0))
        .with_step_dt(1.0 / 30.0)
        .renderer(renderer)
        .build_ui_state(|ui, viewer: &mut Viewer| viewer.show(ui), viewer);
    harness.run_steps(10);
    harness
}

fn press(harness: &mut Harness<Viewer>, name: &str) {
    harness.get_by_label(name).click();
    harness.run_steps(3);
}

fn pointer(harness: &mut Harness<Viewer>, pos: Pos2, pressed: bool) {
    harness.event(Event::PointerMoved(pos));
    harness.event(Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    });
    harness.step();
}

#[test]
fn pauses_steps_and_goes_back() {
    let mut harness = open(plane(), vec![walker()]);
    let at = |harness: &Harness<Viewer>| harness.state().timeline().at();
    let playing = at(&harness);
    harness.run_steps(5);
    assert!(at(&harness) > playing);
    press(&mut harness, "Pause");
    let paused = at(&harness);
    harness.run_steps(5);
    assert_eq!(at(&harness), paused);
    press(&mut harness, "Step");
    assert_eq!(at(&harness), paused + 1);
    press(&mut harness, "Back");
    press(&mut harness, "Back");
    assert_eq!(at(&harness), paused - 1);
    assert_eq!(harness.state().timeline().len(), paused + 2);
    harness.key_press(Key::Space);
    harness.run_steps(5);
    assert!(at(&harness) > paused - 1);
}

#[test]
fn a_rewound_playthrough_plays_the_same_again() {
    let mut harness = open(plane(), vec![walker()]);
    press(&mut harness, "Pause");
    for _ in 0..2 * FRAMES_PER_STEP {
        press(&mut harness, "Step");
    }
    let (shown, frame) = (harness.state().shown(), harness.state().timeline().at());
    for _ in 0..2 * FRAMES_PER_STEP {
        press(&mut harness, "Back");
    }
    assert_ne!(harness.state().shown(), shown);
    for _ in 0..2 * FRAMES_PER_STEP {
        press(&mut harness, "Step");
    }
    assert_eq!(harness.state().timeline().at(), frame);
    assert_eq!(harness.state().shown(), shown);
}

#[test]
fn a_click_moves_the_target() {
    let mut harness = open(plane(), vec![walker()]);
    press(&mut harness, "Pause");
    let before = harness.state().timeline().now().target();
    pointer(&mut harness, GROUND, true);
    pointer(&mut harness, GROUND, false);
    harness.run_steps(2);
    let after = harness.state().timeline().now().target();
    assert_ne!(before, after);
    let at = harness.state().shown().at;
    assert!(
        (after[0] - at[0]).hypot(after[1] - at[1]) < 6.0,
        "{after:?}"
    );
}

#[test]
fn an_obstacle_is_dragged() {
    let task = LocomotionTask::Obstacles(Obstacles {
        // One under every part of the picture.
        side_min: 3.0,
        count: 400,
        ..Obstacles::FAST
    });
    let mut harness = open(task, vec![walker()]);
    press(&mut harness, "Pause");
    let before = harness.state().timeline().now().obstacles();
    let corner = Pos2::new(120.0, 200.0);
    pointer(&mut harness, corner, true);
    for step in 1..=6 {
        harness.event(Event::PointerMoved(
            corner + Vec2::new(12.0 * step as f32, 0.0),
        ));
        harness.step();
    }
    pointer(&mut harness, corner + Vec2::new(72.0, 0.0), false);
    let after = harness.state().timeline().now().obstacles();
    let moved = before.iter().zip(&after).filter(|(a, b)| a != b).count();
    assert_eq!(moved, 1);
}

#[test]
fn a_broken_checkpoint_leaves_the_policy_in_place() {
    let mut harness = open(plane(), vec![broken(), walker()]);
    harness.get_by_value("walker").click();
    harness.run_steps(3);
    harness.get_by_label("broken").click();
    harness.run_steps(3);
    harness.get_by_label("this checkpoint is damaged");
    let at = harness.state().timeline().at();
    harness.run_steps(5);
    assert!(harness.state().timeline().at() > at);
}

#[test]
fn is_steered_by_keys() {
    let mut harness = open(plane(), Vec::new());
    let away = |harness: &Harness<Viewer>| {
        // The camera looks from (sin, cos) of its yaw, 0.7.
        let [x, z] = harness.state().shown().at;
        -(x * 0.7f32.sin() + z * 0.7f32.cos())
    };
    let began = away(&harness);
    harness.key_down(Key::W);
    harness.run_steps(120);
    harness.key_up(Key::W);
    assert!(away(&harness) - began > 1.5, "{}", away(&harness) - began);
}

#[test]
fn clips_play_as_recorded() {
    let mut harness = open(plane(), Vec::new());
    let clip = &DATABASE.clips[0];
    let seconds = clip.frames as f32 / 30.0;
    harness
        .get_by_label(&format!("{} ({seconds:.0} s)", clip.name))
        .click();
    harness.run_steps(6);
    let first = harness.state().shown();
    harness.run_steps(5);
    let later = harness.state().shown();
    assert!(later.frame > first.frame && later.frame < clip.first + clip.frames);
    let [x, z, ..] = DATABASE.path[later.frame];
    assert_eq!(later.at, [x, z]);
}

#[test]
fn tells_why_a_frame_was_chosen() {
    let mut harness = open(LocomotionTask::Obstacles(Obstacles::FAST), vec![walker()]);
    harness.run_steps(10);
    harness.get_by_label("Obstacle maps");
    harness.get_by_label("trajectory");
    let picture = harness.render().expect("a picture");
    assert_eq!((picture.width(), picture.height()), (900, 560));
    // The scene is in it: a ground with more than one shade.
    let shades: std::collections::HashSet<_> =
        (0..500).map(|x| picture.get_pixel(x, 300).0).collect();
    assert!(shades.len() > 5);
}

#[test]
fn an_obstacle_moved_by_hand_is_seen() {
    let context = context(LocomotionTask::Obstacles(Obstacles::FAST));
    let mut playthrough = Playthrough::new(&context, 0);
    let before = playthrough.env.maps.clone();
    playthrough.move_obstacle(0, playthrough.shown.at);
    assert_ne!(playthrough.env.maps, before);
}

#[test]
fn a_target_set_on_arrival_stays() {
    let context = context(plane());
    let mut playthrough = Playthrough::new(&context, 0);
    playthrough.set_target(playthrough.shown.at);
    playthrough.advance(&context, &Walker).unwrap();
    let termination = playthrough.step.as_ref().map(|step| step.termination);
    assert_eq!(termination, Some(termination::SUCCESS));
    playthrough.set_target([40.0, 30.0]);
    for _ in 0..=FRAMES_PER_STEP {
        playthrough.advance(&context, &Walker).unwrap();
    }
    assert_eq!(playthrough.target(), [40.0, 30.0]);
}
