//! Pictures of 1280 x 720 pixels: one character, one among obstacles, and crowds.

use super::clock::seconds;
use super::recorder::{Recorder, Workload};
use super::roofline::ItemCost;
use super::stage::BenchContext;
use crate::env::live_view::LiveView;
use crate::env::locomotion::{EnvConfig, LEVELS, LocomotionTask, Obstacles, Plane};
use crate::gpu::{Device, Gpu};
use crate::playback::player::Style;
use crate::train::playthrough::{Playthrough, PlaythroughContext};
use crate::view::debug_draw::scene;
use crate::view::painter::Drawable;
use crate::view::{Camera, Crowd, RenderTarget, Renderer, Scene};
use anyhow::{Context, Result};

const SIZE: [u32; 2] = [1280, 720];
/// Characters of a crowd.
const CROWDS: [usize; 3] = [256, 1024, 4096];

/// Measures what draws: nothing does on the CPU.
pub fn measure(bench: &BenchContext, record: &mut Recorder) -> Result<()> {
    let Device::Gpu(gpu) = &bench.on.device else {
        return Ok(());
    };
    if !bench.plan.selects("drawing") {
        return Ok(());
    }
    let mut studio = Studio::new(gpu);
    let plane = LocomotionTask::Plane(Plane::default());
    for task in [plane, LocomotionTask::Obstacles(Obstacles::FAST)] {
        let context = PlaythroughContext::new(bench.matcher.clone(), task, Style::BEST);
        let scene = scene(&Playthrough::new(&context, 0), &context);
        let time = seconds(bench.on, || studio.draw(&scene, None))?;
        record.add(
            bench.on,
            bench.roofline,
            workload(bench, task.name(), 1),
            time,
        );
    }
    for envs in CROWDS {
        let config = EnvConfig {
            task: plane,
            envs,
            seed: 1,
            level: LEVELS - 1,
        };
        let mut batch = config.open(&bench.on.device, bench.matcher)?;
        let live_view = batch.live_view()?;
        let live_view = live_view
            .and_then(LiveView::locomotion)
            .context("a batch of this task can be watched")?;
        let database = &bench.matcher.database;
        let crowd = Crowd::new(&studio.renderer, database, live_view, &plane, envs);
        studio.camera.distance = 8.0 + 0.6 * crowd.side;
        studio.camera.pitch = 0.5;
        let scene = Scene::default();
        let time = seconds(bench.on, || studio.draw(&scene, Some(&crowd)))?;
        record.add(
            bench.on,
            bench.roofline,
            workload(bench, "crowd", envs),
            time,
        );
    }
    Ok(())
}

fn workload<'a>(bench: &BenchContext, variant: &'a str, envs: usize) -> Workload<'a> {
    Workload {
        stage: "drawing",
        variant,
        frames: bench.matcher.database.candidates.len(),
        envs,
        batch: 1,
        bytes: None,
        cost: ItemCost::default(),
    }
}

struct Studio {
    renderer: Renderer,
    target: RenderTarget,
    camera: Camera,
}

impl Studio {
    fn new(gpu: &Gpu) -> Self {
        let renderer = Renderer::new(gpu);
        Studio {
            target: RenderTarget::new(&renderer.device, SIZE),
            camera: Camera::default(),
            renderer,
        }
    }

    fn draw(&mut self, scene: &Scene, beside: Option<&dyn Drawable>) -> Result<()> {
        self.renderer
            .draw(scene, beside, &self.camera, &self.target);
        let wait = wgpu::PollType::wait_indefinitely();
        self.renderer.device.poll(wait)?;
        Ok(())
    }
}
