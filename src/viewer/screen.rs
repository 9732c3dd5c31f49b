//! The part of the window that shows the scene.

use crate::gpu::Gpu;
use crate::view::camera::Ray;
use crate::view::painter::Drawable;
use crate::view::{Camera, RenderTarget, Renderer, Scene};
use eframe::egui::{self, Sense, TextureId, Ui, Vec2};
use eframe::egui_wgpu::RenderState;
use eframe::wgpu::FilterMode;

/// Radians a point of dragging.
const ORBIT: f32 = 0.007;
/// Share of the distance a point of dragging with the other button.
const PAN: f32 = 0.0012;
/// Share of the distance a point of scrolling.
const ZOOM: f32 = 0.002;
/// Software rasterisers draw fewer pixels: every second one of each row and column.
const COARSE: f32 = 0.5;

/// A texture in a window, and the renderer that draws into it.
pub struct Screen {
    /// The renderer of the scene.
    pub renderer: Renderer,
    target: RenderTarget,
    window: RenderState,
    texture: TextureId,
    /// Pixels drawn a pixel shown, along a side.
    scale: f32,
}

/// What the pointer did, and where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PointerAction {
    /// Pressed and released.
    Click(Ray),
    /// Pressed, about to drag.
    Press(Ray),
    /// Held while pressed.
    Drag(Ray),
    /// Released after a drag.
    Release,
}

impl Screen {
    /// In a window on the device that `gpu` has.
    pub fn new(gpu: &Gpu, window: &RenderState) -> Screen {
        let renderer = Renderer::new(gpu);
        let target = RenderTarget::new(&renderer.device, [16, 16]);
        let texture = window.renderer.write().register_native_texture(
            &window.device,
            &target.shown(),
            FilterMode::Linear,
        );
        Screen {
            renderer,
            target,
            window: window.clone(),
            texture,
            scale: if gpu.software { COARSE } else { 1.0 },
        }
    }

    /// Draws the scene over what is left of the window. `grabbed`: dragging is the caller's, not the
    /// camera's.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        scene: &Scene,
        beside: Option<&dyn Drawable>,
        camera: &mut Camera,
        grabbed: bool,
    ) -> Option<PointerAction> {
        let points = ui.available_size().max(Vec2::splat(16.0));
        let pixels = points * ui.ctx().pixels_per_point() * self.scale;
        self.fit([pixels.x, pixels.y].map(|side| (side.round() as u32).clamp(16, 8192)));
        self.renderer.draw(scene, beside, camera, &self.target);
        let image =
            egui::Image::from_texture((self.texture, points)).sense(Sense::click_and_drag());
        let response = ui.add(image);
        if response.hovered() {
            let scrolled = ui.input(|input| input.smooth_scroll_delta().y);
            camera.zoom((-ZOOM * scrolled).exp());
        }
        let aspect = points.x / points.y;
        let pointer = response.interact_pointer_pos();
        let ray = |camera: &Camera| {
            let place = (pointer? - response.rect.center()) / (0.5 * response.rect.size());
            Some(camera.ray([place.x, -place.y].into(), aspect))
        };
        let dragged = response.drag_delta();
        if response.drag_stopped() {
            return Some(PointerAction::Release);
        }
        if response.clicked() {
            return ray(camera).map(PointerAction::Click);
        }
        if response.drag_started() && response.dragged_by(egui::PointerButton::Primary) {
            // Where the button went down, not where the drag was noticed.
            return ray(camera).map(PointerAction::Press);
        }
        if grabbed {
            return ray(camera).map(PointerAction::Drag);
        }
        if response.dragged_by(egui::PointerButton::Secondary) {
            let metre = camera.distance * PAN;
            camera.pan(-metre * dragged.x, metre * dragged.y);
        } else {
            camera.orbit(-ORBIT * dragged.x, ORBIT * dragged.y);
        }
        None
    }

    /// Width of the picture by its height.
    pub fn aspect(&self) -> f32 {
        self.target.aspect()
    }

    fn fit(&mut self, size: [u32; 2]) {
        if size == self.target.size {
            return;
        }
        self.target = RenderTarget::new(&self.renderer.device, size);
        self.window
            .renderer
            .write()
            .update_egui_texture_from_wgpu_texture(
                &self.window.device,
                &self.target.shown(),
                FilterMode::Linear,
                self.texture,
            );
    }
}
