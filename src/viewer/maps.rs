//! The two obstacle maps, as the policy sees them.

use crate::kernels::locomotion::locomotion_layout::{CELLS, MAPS};
use crate::kernels::locomotion::rasterize_maps::cell;
use eframe::egui::{Color32, Pos2, Rect, Sense, Ui, Vec2};

/// Points a side of a cell.
const SIDE: f32 = 7.0;

/// Draws an environment's maps, now and before: ahead is up, left is left, the character
/// in the middle.
pub fn show(ui: &mut Ui, maps: &[u32]) {
    ui.horizontal(|ui| {
        for (index, name) in (0..MAPS).zip(["now", "before"]) {
            ui.vertical(|ui| {
                ui.small(name);
                map(ui, |row, column| cell(maps, index, row, column));
            });
        }
    });
}

fn map(ui: &mut Ui, shade: impl Fn(usize, usize) -> u8) {
    let size = Vec2::splat(SIDE * CELLS as f32);
    let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 0.0, Color32::from_gray(40));
    for row in 0..CELLS {
        for column in 0..CELLS {
            // Rows go from behind to ahead, columns from right to left.
            let (x, y) = (CELLS - 1 - column, CELLS - 1 - row);
            let corner = rect.min + SIDE * Vec2::new(x as f32, y as f32);
            let cell = Rect::from_min_size(corner, Vec2::splat(SIDE - 1.0));
            let share = f32::from(shade(row, column)) / 255.0;
            let colour = Color32::from_rgb(205, 120, 70).gamma_multiply(share);
            painter.rect_filled(cell, 0.0, colour);
        }
    }
    let middle: Pos2 = rect.center();
    painter.circle_filled(middle, 3.0, Color32::WHITE);
    painter.arrow(middle, Vec2::new(0.0, -2.0 * SIDE), (1.5, Color32::WHITE));
}
