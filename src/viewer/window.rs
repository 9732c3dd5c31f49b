//! Opens windows, on the device that everything else uses.

use super::app::Viewer;
use super::body_app::BodyViewer;
use super::policies::PolicyEntry;
use super::watch::{Crowded, Watch, WatchedMotion};
use crate::gpu::Gpu;
use crate::train::body_policy::BodyPolicy;
use crate::train::controller::Controller;
use crate::train::playthrough::PlaythroughContext;
use crate::view::body_playthrough::BodyContext;
use anyhow::{Context, Result, anyhow};
use eframe::egui_wgpu::{RenderState, WgpuConfiguration, WgpuSetup, WgpuSetupExisting};
use eframe::{NativeOptions, egui};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

/// What a window shows.
pub trait Contents {
    /// Draws the contents and takes input.
    fn show(&mut self, ui: &mut egui::Ui);
}

impl Contents for Viewer {
    fn show(&mut self, ui: &mut egui::Ui) {
        Viewer::show(self, ui);
    }
}

impl Contents for BodyViewer {
    fn show(&mut self, ui: &mut egui::Ui) {
        BodyViewer::show(self, ui);
    }
}

impl Contents for Crowded {
    fn show(&mut self, ui: &mut egui::Ui) {
        Crowded::show(self, ui);
    }
}

/// Why the device was lost, once it is.
type Lost = Arc<OnceLock<String>>;

struct Window {
    contents: Box<dyn Contents>,
    lost: Lost,
    /// Whether there is nothing more to show.
    over: Arc<AtomicBool>,
}

impl eframe::App for Window {
    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        let over = self.over.load(Ordering::Relaxed);
        match over || self.lost.get().is_some() {
            true => ui.ctx().send_viewport_cmd(egui::ViewportCommand::Close),
            false => self.contents.show(ui),
        }
    }
}

/// Egui's own setup on a device that is already open.
pub fn shared(gpu: &Gpu) -> WgpuSetup {
    WgpuSetup::Existing(WgpuSetupExisting {
        instance: gpu.setup.instance.clone(),
        adapter: gpu.setup.adapter.clone(),
        device: gpu.setup.device.clone(),
        queue: gpu.setup.queue.clone(),
    })
}

/// Shows a controller until its window is closed.
///
/// # Errors
/// There is no display, a policy cannot be loaded, or the GPU was lost.
pub fn play(
    gpu: &Gpu,
    title: &str,
    context: PlaythroughContext,
    policies: Vec<PolicyEntry<Box<dyn Controller>>>,
) -> Result<()> {
    let viewer = |window: &RenderState| Viewer::new(gpu, window, context, policies);
    let over = Arc::new(AtomicBool::new(false));
    open(gpu, title, over, |window| Ok(Box::new(viewer(window)?)))
}

/// Shows a simulated body until its window is closed.
///
/// # Errors
/// There is no display, a policy cannot be loaded, or the GPU was lost.
pub fn play_body(
    gpu: &Gpu,
    title: &str,
    context: BodyContext,
    policies: Vec<PolicyEntry<BodyPolicy>>,
) -> Result<()> {
    let viewer = |window: &RenderState| BodyViewer::new(gpu, window, context, policies);
    let over = Arc::new(AtomicBool::new(false));
    open(gpu, title, over, |window| Ok(Box::new(viewer(window)?)))
}

/// Shows a training until it is `over` or its window is closed; `motion` says what it is of where that is
/// motion matching.
///
/// # Errors
/// There is no display, or the GPU was lost.
pub fn watch(
    gpu: &Gpu,
    motion: Option<WatchedMotion>,
    watch: Arc<Watch>,
    over: Arc<AtomicBool>,
) -> Result<()> {
    open(gpu, "footwork: training", over, |window| {
        Ok(Box::new(Crowded::new(gpu, window, motion, watch)))
    })
}

fn open(
    gpu: &Gpu,
    title: &str,
    over: Arc<AtomicBool>,
    contents: impl FnOnce(&RenderState) -> Result<Box<dyn Contents>>,
) -> Result<()> {
    let lost = Lost::default();
    let told = lost.clone();
    gpu.setup
        .device
        .set_device_lost_callback(move |_, message| {
            // The first reason is the one to tell.
            let _ = told.set(message);
        });
    // What is drawn after that fails, which wgpu would panic about.
    let failed = lost.clone();
    gpu.setup
        .device
        .on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            let _ = failed.set(error.to_string());
        }));
    let options = NativeOptions {
        viewport: egui::ViewportBuilder::default().with_inner_size([1280.0, 760.0]),
        wgpu_options: WgpuConfiguration {
            wgpu_setup: shared(gpu),
            ..Default::default()
        },
        ..Default::default()
    };
    let kept = lost.clone();
    let create = move |context: &eframe::CreationContext| {
        let window = context.wgpu_render_state.as_ref();
        let window = window.context("the window does not draw with wgpu")?;
        let contents = contents(window)?;
        Ok(Box::new(Window {
            contents,
            lost,
            over,
        }) as Box<dyn eframe::App>)
    };
    // wgpu panics when a surface cannot be had, as of a device too busy to answer in time: that is
    // the end of the window, and not of a training beside it.
    let shown = AssertUnwindSafe(|| eframe::run_native(title, options, Box::new(create)));
    let closed = catch_unwind(shown);
    if let Some(why) = kept.get() {
        return Err(anyhow!(
            "the GPU was lost: {why}; start again, or draw to files with `footwork render`"
        ));
    }
    let Ok(closed) = closed else {
        return Err(anyhow!("the window could not be drawn any more"));
    };
    closed.map_err(|error| match error {
        eframe::Error::AppCreation(error) => anyhow!("{error}"),
        eframe::Error::Winit(_) | eframe::Error::WinitEventLoop(_) => anyhow!(
            "no window can be opened: there is no display. `footwork render` draws a run to files without one"
        ),
        error => anyhow!("the window cannot be drawn: {error}"),
    })
}
