use crate::{DATABASE, MATCHER, Picture, gpu};
use footwork::container::Section;
use footwork::env::live_view::LocomotionView;
use footwork::env::locomotion::{EnvConfig, EnvState, LocomotionTask, Obstacles, Plane};
use footwork::env::{EnvBatch, Transition};
use footwork::gpu::{Array, Device};
use footwork::kernels::locomotion::locomotion_layout::{boxes, state_f32, state_u32};
use footwork::playback::PlacedFrame;
use footwork::playback::capsule_rig::CapsuleRig;
use footwork::view::scene::Cuboid;
use footwork::view::{Camera, Crowd, Renderer, Scene};
use glam::Vec3;

const SIZE: [u32; 2] = [240, 160];

fn one(device: &Device, task: LocomotionTask) -> EnvBatch {
    let config = EnvConfig {
        task,
        envs: 1,
        seed: 5,
        level: 9,
    };
    config.open(device, &MATCHER).unwrap()
}

fn state(batch: &EnvBatch, task: LocomotionTask) -> EnvState {
    let mut section = Section::default();
    batch.parts[0].save(&mut section).unwrap();
    EnvState::load(&mut section, 1, task.obstacles(), DATABASE.frames()).unwrap()
}

fn live_view(batch: &mut EnvBatch) -> LocomotionView {
    batch.live_view().unwrap().unwrap().locomotion().unwrap()
}

/// Plays a step whose action is the mean trajectory.
fn step(batch: &mut EnvBatch, device: &Device) {
    let spec = batch.spec();
    batch.parts[0].step(
        &Array::zeroed(device, spec.action),
        0,
        Transition {
            step: 0,
            reward: &mut Array::zeroed(device, 1),
            style_reward: &mut Array::zeroed(device, 1),
            termination: &mut Array::zeroed(device, 1),
            group: &mut Array::zeroed(device, 1),
            final_observation: &mut Array::zeroed(device, spec.observation.dim()),
        },
    );
}

/// A crowd of one must look like its only character, wherever its state is kept.
fn one_of_a_crowd(device: Device) {
    let task = LocomotionTask::Plane(Plane::default());
    let mut batch = one(&device, task);
    let mut renderer = Renderer::new(&gpu());
    let live_view = live_view(&mut batch);
    let crowd = Crowd::new(&renderer, &DATABASE, live_view, &task, 1);
    for _ in 0..3 {
        step(&mut batch, &device);
    }
    let state = state(&batch, task);
    let shown = PlacedFrame {
        frame: state.state_u32[state_u32::FRAME] as usize,
        at: [state.state_f32[state_f32::X], state.state_f32[state_f32::Z]],
        heading: [
            state.state_f32[state_f32::HEADING_X],
            state.state_f32[state_f32::HEADING_Z],
        ],
    };
    let mut scene = Scene::default();
    let body = CapsuleRig::of(&DATABASE.skeleton, &DATABASE.roles);
    scene.character(&body, &DATABASE.skeleton, &shown.pose(&DATABASE));
    let target = Vec3::new(
        state.state_f32[state_f32::TARGET_X],
        0.0,
        state.state_f32[state_f32::TARGET_Z],
    );
    scene.capsule(
        target,
        0.06,
        target + 0.5 * Vec3::Y,
        0.12,
        [0.06, 0.50, 0.22],
    );
    let mut camera = Camera::default();
    camera.follow(shown.at, 1.0);
    let alone = Picture::with(&mut renderer, &scene, None, &camera, SIZE);
    let crowd = Picture::with(
        &mut renderer,
        &Scene::default(),
        Some(&crowd),
        &camera,
        SIZE,
    );
    let empty = Picture::with(&mut renderer, &Scene::default(), None, &camera, SIZE);
    // The crowd's capsules have fewer corners.
    let (far, _) = alone.difference(&crowd);
    assert!(far < 0.01, "{far}");
    let (far, _) = alone.difference(&empty);
    assert!(far > 0.03, "{far}");
}

/// Its obstacles must be where a single environment's would be drawn.
fn obstacles_of_a_crowd(device: Device) {
    let task = LocomotionTask::Obstacles(Obstacles::FAST);
    let mut batch = one(&device, task);
    let mut renderer = Renderer::new(&gpu());
    let live_view = live_view(&mut batch);
    let crowd = Crowd::new(&renderer, &DATABASE, live_view, &task, 1);
    let state = state(&batch, task);
    let mut scene = Scene::default();
    for slot in 0..100 {
        let at = |field: usize| state.boxes[field * 100 + slot];
        let own = (slot as f32 * 0.618_034).fract();
        let height = 0.35 * (0.8 + 0.4 * own);
        scene.cuboids.push(Cuboid {
            centre: [at(boxes::X), 0.5 * height, at(boxes::Z)],
            half: [at(boxes::HALF_X), 0.5 * height, at(boxes::HALF_Z)],
            rotation: Cuboid::UPRIGHT,
            colour: [0.42, 0.34, 0.30].map(|value| value * (0.75 + 0.5 * own)),
        });
    }
    let camera = Camera {
        distance: 30.0,
        pitch: 1.0,
        ..Camera::default()
    };
    let mut draw = |scene: &Scene, crowd| Picture::with(&mut renderer, scene, crowd, &camera, SIZE);
    let alone = draw(&scene, None);
    let crowd = draw(&Scene::default(), Some(&crowd));
    let empty = draw(&Scene::default(), None);
    // The crowd has a character and its target besides.
    let (far, _) = alone.difference(&crowd);
    assert!(far < 0.02, "{far}");
    let (far, _) = alone.difference(&empty);
    assert!(far > 0.1, "{far}");
}

#[test]
fn obstacles_are_drawn_from_where_they_are_kept() {
    obstacles_of_a_crowd(Device::from(gpu()));
    obstacles_of_a_crowd(Device::Cpu);
}

#[test]
fn a_crowd_is_drawn_from_the_gpus_own_buffers() {
    one_of_a_crowd(Device::from(gpu()));
}

#[test]
fn a_crowd_is_drawn_from_a_training_on_the_cpu() {
    one_of_a_crowd(Device::Cpu);
}
