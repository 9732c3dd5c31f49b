//! Opens the window, on the device that everything else uses.

use super::viewer::{Choice, Viewer};
use crate::gpu::Gpu;
use crate::view::rollout::Stage;
use anyhow::{Context, Result, anyhow};
use eframe::egui_wgpu::{WgpuConfiguration, WgpuSetup, WgpuSetupExisting};
use eframe::{NativeOptions, egui};
use std::sync::{Arc, OnceLock};

/// Why the device was lost, once it is.
type Lost = Arc<OnceLock<String>>;

struct Window {
    viewer: Viewer,
    lost: Lost,
}

impl eframe::App for Window {
    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        match self.lost.get() {
            Some(_) => ui.ctx().send_viewport_cmd(egui::ViewportCommand::Close),
            None => self.viewer.show(ui),
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

/// Shows a window until it is closed.
///
/// # Errors
/// There is no display, a policy cannot be loaded, or the GPU was lost.
pub fn open(gpu: &Gpu, title: &str, stage: Stage, choices: Vec<Choice>) -> Result<()> {
    let lost = Lost::default();
    let told = lost.clone();
    gpu.setup
        .device
        .set_device_lost_callback(move |_, message| {
            // The first reason is the one to tell.
            let _ = told.set(message);
        });
    let options = NativeOptions {
        viewport: egui::ViewportBuilder::default().with_inner_size([1280.0, 760.0]),
        wgpu_options: WgpuConfiguration {
            wgpu_setup: shared(gpu),
            ..Default::default()
        },
        ..Default::default()
    };
    let (gpu, kept) = (gpu.clone(), lost.clone());
    let create = move |context: &eframe::CreationContext| {
        let window = context.wgpu_render_state.as_ref();
        let window = window.context("the window does not draw with wgpu")?;
        let viewer = Viewer::new(&gpu, window, stage, choices)?;
        Ok(Box::new(Window { viewer, lost }) as Box<dyn eframe::App>)
    };
    let closed = eframe::run_native(title, options, Box::new(create));
    if let Some(why) = kept.get() {
        return Err(anyhow!(
            "the GPU was lost: {why}; start again, or draw to files with `footwork render`"
        ));
    }
    closed.map_err(|error| match error {
        eframe::Error::AppCreation(error) => anyhow!("{error}"),
        eframe::Error::Winit(_) | eframe::Error::WinitEventLoop(_) => anyhow!(
            "no window can be opened ({error}): is there a display? `footwork render` draws to files without one"
        ),
        error => anyhow!("the window cannot be drawn: {error}"),
    })
}
