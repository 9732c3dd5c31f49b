//! Time of a picture, 1280 x 720: one character, one among obstacles, and crowds.

use criterion::{Criterion, criterion_group, criterion_main};
use footwork::gpu::{Device, Gpu};
use footwork::motion::database::Database;
use footwork::motion::normalise::Weights;
use footwork::motion::synthetic;
use footwork::playback::player::Style;
use footwork::view::debug_draw::scene;
use footwork::view::playthrough::{Playthrough, PlaythroughContext};
use footwork::view::{Camera, RenderTarget, Crowd, Renderer, Scene};
use footwork::env::locomotion::{self, LEVELS, Obstacles, Plane, Setup, Task};
use std::hint::black_box;
use std::sync::Arc;

struct Studio {
    renderer: Renderer,
    target: RenderTarget,
    camera: Camera,
}

impl Studio {
    fn draw(&mut self, scene: &Scene, crowd: Option<&Crowd>) {
        self.renderer
            .draw(black_box(scene), crowd, &self.camera, &self.target);
        let wait = wgpu::PollType::wait_indefinitely();
        self.renderer.device.poll(wait).expect("a picture");
    }
}

fn pictures(criterion: &mut Criterion) {
    let gpu = Gpu::drawing().expect("a GPU or lavapipe");
    let (clips, roles) = synthetic::perform(1, 4.0);
    let database = Database::build(&clips, roles, Weights::PAPER).expect("long enough");
    let database = Arc::new(database);
    let renderer = Renderer::new(&gpu);
    let mut studio = Studio {
        target: RenderTarget::new(&renderer.device, [1280, 720]),
        camera: Camera::default(),
        renderer,
    };
    let mut group = criterion.benchmark_group(&gpu.name);
    let tasks = [
        ("a character", Task::Plane(Plane::default())),
        (
            "a character among obstacles",
            Task::Obstacles(Obstacles::FAST),
        ),
    ];
    for (name, task) in tasks {
        let context = PlaythroughContext::new(database.clone(), task, Style::BEST);
        let scene = scene(&Playthrough::new(&context, 0), &context);
        group.bench_function(name, |bencher| bencher.iter(|| studio.draw(&scene, None)));
    }
    for envs in [256, 1024, 4096] {
        let task = Task::Plane(Plane::default());
        let setup = Setup {
            task,
            envs,
            horizon: 1,
            seed: 1,
            level: LEVELS - 1,
        };
        let mut world = locomotion::open(&Device::from(gpu.clone()), &database, &setup);
        let watched = world.watch().expect("a device");
        let crowd = Crowd::new(&studio.renderer, &database, watched, &task, envs);
        studio.camera.distance = 8.0 + 0.6 * crowd.side;
        studio.camera.pitch = 0.5;
        let scene = Scene::default();
        group.bench_function(format!("a crowd of {envs}"), |bencher| {
            bencher.iter(|| studio.draw(&scene, Some(&crowd)));
        });
    }
}

criterion_group! {
    name = view;
    config = Criterion::default().sample_size(10);
    targets = pictures
}
criterion_main!(view);
