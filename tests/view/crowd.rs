use crate::{DATABASE, Picture, gpu};
use footwork::gpu::Device;
use footwork::kernels::layout::{real, whole};
use footwork::playback::Shown;
use footwork::view::body::Body;
use footwork::view::{Camera, Crowd, Renderer, Scene};
use footwork::world::{self, Plane, Setup, Task};
use glam::Vec3;

const SIZE: [u32; 2] = [240, 160];

/// A crowd of one must look like its only character, wherever its state is kept.
fn one_of_a_crowd(device: Device) {
    let setup = Setup {
        task: Task::Plane(Plane::default()),
        envs: 1,
        horizon: 4,
        seed: 5,
        level: 9,
    };
    let mut world = world::open(&device, &DATABASE, &setup);
    let mut renderer = Renderer::new(&gpu());
    let watched = world.watch().unwrap();
    let crowd = Crowd::new(&renderer, &DATABASE, watched, 1);
    for _ in 0..3 {
        let observed = world.observe();
        let action = observed.zeros_like().narrow(1, 0, 12);
        world.step(action);
    }
    let state = world.snapshot().unwrap();
    let shown = Shown {
        frame: state.whole[whole::FRAME] as usize,
        at: [state.real[real::X], state.real[real::Z]],
        heading: [state.real[real::HEADING_X], state.real[real::HEADING_Z]],
    };
    let mut scene = Scene::default();
    let body = Body::of(&DATABASE.skeleton, &DATABASE.roles);
    body.draw(&mut scene, &DATABASE.skeleton, &shown.pose(&DATABASE));
    let target = Vec3::new(state.real[real::TARGET_X], 0.0, state.real[real::TARGET_Z]);
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

#[test]
fn a_crowd_is_drawn_from_the_gpus_own_buffers() {
    one_of_a_crowd(Device::from(gpu()));
}

#[test]
fn a_crowd_is_drawn_from_a_training_on_the_cpu() {
    one_of_a_crowd(Device::Cpu);
}
