//! The bars over the picture of a bout: the damage that each fighter has done, and its knock-downs.

use crate::env::humanoid::boxing::bout::Bout;

/// Red's colour and blue's, sRGB.
pub const CORNERS: [[u8; 3]; 2] = [[214, 48, 42], [44, 98, 214]];
/// Where a bar is empty.
const EMPTY: [u8; 3] = [52, 56, 64];
/// Damage of a full bar, N s; a bar that is full already shows the part of the other's.
const FULL: f32 = 100.0;
/// Margin, and height of a bar, in parts of the picture's smaller side.
const MARGIN: f32 = 0.04;
const HEIGHT: f32 = 0.045;
/// Width of a bar, in parts of the picture's.
const WIDTH: f32 = 0.4;

/// How full each one's bar is, from 0 to 1.
pub fn fill(bout: &Bout) -> [f32; 2] {
    let [red, blue] = bout.damage;
    bout.damage.map(|damage| damage / red.max(blue).max(FULL))
}

/// Draws the bars into a picture, RGB: red's at the left, blue's at the right, each filled from its corner on; below
/// them a square a knock-down.
pub fn draw(rgb: &mut [u8], [width, height]: [u32; 2], bout: &Bout) {
    let side = width.min(height) as f32;
    let pixels = |part: f32, of: f32| ((part * of).round() as usize).max(1);
    let (margin, high) = (pixels(MARGIN, side), pixels(HEIGHT, side));
    let wide = pixels(WIDTH, width as f32);
    let mut picture = Picture {
        rgb,
        width: width as usize,
    };
    for (corner, fill) in fill(bout).into_iter().enumerate() {
        let full = (fill * wide as f32).round() as usize;
        picture.bar(corner, [margin, margin], [wide, high], EMPTY);
        picture.bar(corner, [margin, margin], [full, high], CORNERS[corner]);
        for down in 0..bout.knockdowns[corner] as usize {
            let at = [margin + 2 * high * down, margin + high + high / 2];
            picture.bar(corner, at, [high, high], CORNERS[corner]);
        }
    }
}

struct Picture<'a> {
    rgb: &'a mut [u8],
    width: usize,
}

impl Picture<'_> {
    /// Fills a rectangle that begins so far from the upper left corner or, of blue, from the upper right one.
    fn bar(
        &mut self,
        corner: usize,
        [x, y]: [usize; 2],
        [wide, high]: [usize; 2],
        colour: [u8; 3],
    ) {
        let end = (x + wide).min(self.width);
        let columns = match corner {
            0 => x.min(end)..end,
            _ => self.width - end..self.width - x.min(end),
        };
        let rows = self.rgb.chunks_exact_mut(3 * self.width).skip(y).take(high);
        for row in rows {
            let pixels = row[3 * columns.start..3 * columns.end].chunks_exact_mut(3);
            pixels.for_each(|pixel| pixel.copy_from_slice(&colour));
        }
    }
}
