//! A training, watched: all its environments at once.

use super::pace::Pace;
use super::screen::Screen;
use crate::env::EnvBatch;
use crate::env::live_view::LiveView;
use crate::env::locomotion::LocomotionTask;
use crate::gpu::Gpu;
use crate::motion::database::Database;
use crate::train::metrics::UpdateMetrics;
use crate::view::painter::Drawable;
use crate::view::{BodyCrowd, Camera, Crowd, Scene};
use anyhow::Result;
use eframe::egui::{self, Ui};
use eframe::egui_wgpu::RenderState;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// What a training leaves for the window that shows it.
#[derive(Default)]
pub struct Watch {
    /// The environments, once they are open; taken by who draws them.
    view: Mutex<Option<LiveView>>,
    /// The latest update.
    row: Mutex<Option<UpdateMetrics>>,
}

impl Watch {
    /// Takes in what there is to see of the environments.
    ///
    /// # Errors
    /// The device was lost.
    pub fn opened(&self, envs: &mut EnvBatch) -> Result<()> {
        *lock(&self.view) = envs.live_view()?;
        Ok(())
    }

    /// Takes the latest update in.
    pub fn updated(&self, row: &UpdateMetrics) {
        *lock(&self.row) = Some(row.clone());
    }
}

fn lock<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What a training by motion matching is of.
pub struct WatchedMotion {
    /// The motion.
    pub database: Arc<Database>,
    /// The task with its choices.
    pub task: LocomotionTask,
    /// Number of environments.
    pub envs: usize,
}

/// The window of a watched training.
pub struct Crowded {
    /// Nothing where bodies are simulated.
    motion: Option<WatchedMotion>,
    watch: Arc<Watch>,
    /// Once the environments are open.
    crowd: Option<Box<dyn Drawable>>,
    camera: Camera,
    screen: Screen,
    pace: Pace,
}

impl Crowded {
    /// A window on a training that is about to begin.
    pub fn new(
        gpu: &Gpu,
        window: &RenderState,
        motion: Option<WatchedMotion>,
        watch: Arc<Watch>,
    ) -> Crowded {
        Crowded {
            motion,
            watch,
            crowd: None,
            camera: Camera::default(),
            screen: Screen::new(gpu, window),
            pace: Pace::new(gpu),
        }
    }

    /// Draws the window and takes its input.
    pub fn show(&mut self, ui: &mut Ui) {
        self.open();
        egui::Panel::bottom("training").show(ui, |ui| {
            let row = lock(&self.watch.row);
            ui.label(row.as_ref().map_or("the first update ...".into(), told));
        });
        let frame = egui::Frame::NONE;
        egui::CentralPanel::default().frame(frame).show(ui, |ui| {
            if self.crowd.is_none() {
                ui.centered_and_justified(|ui| ui.label("opening the environments ..."));
                return;
            }
            let scene = Scene::default();
            let crowd = self.crowd.as_deref();
            self.screen.show(ui, &scene, crowd, &mut self.camera, false);
        });
        let next = self.pace.next(&self.screen.renderer.queue);
        ui.ctx().request_repaint_after(next);
    }

    fn open(&mut self) {
        let view = lock(&self.watch.view).take();
        let Some((crowd, side)) = view.and_then(|view| self.crowd_of(view)) else {
            return;
        };
        self.camera.distance = 8.0 + 0.6 * side;
        self.camera.pitch = 0.5;
        self.crowd = Some(crowd);
    }

    /// What draws the environments, and the side of the square that they fill, m.
    fn crowd_of(&self, view: LiveView) -> Option<(Box<dyn Drawable>, f32)> {
        let renderer = &self.screen.renderer;
        match view {
            LiveView::Bodies(view) => {
                let crowd = BodyCrowd::new(renderer, view);
                let side = crowd.side;
                Some((Box::new(crowd), side))
            }
            LiveView::Locomotion(view) => {
                let of = self.motion.as_ref()?;
                let crowd = Crowd::new(renderer, &of.database, view, &of.task, of.envs);
                let side = crowd.side;
                Some((Box::new(crowd), side))
            }
        }
    }
}

/// An update in a line.
fn told(row: &UpdateMetrics) -> String {
    let level = row
        .level
        .map_or(String::new(), |level| format!("level {level}  "));
    let success = row
        .success
        .map_or("-".into(), |share| format!("{:.1} %", 100.0 * share));
    let steps = row.steps;
    let pace = row.steps_per_s;
    format!("{steps} steps  {level}success {success}  {pace:.0} steps/s")
}
