//! A white surface with smooth lines, discs and text on it.
//!
//! Everything is drawn three times too large and then averaged down, which smooths
//! every edge alike. Coordinates and lengths are pixels of the finished picture, from
//! its top left corner, and may be fractions.

use std::path::Path;

use plotters::backend::{BitMapBackend, DrawingBackend};
use plotters::style::{Color, RGBColor, ShapeStyle};

use super::{ReportError, font, png_file};

/// How many times larger than the finished picture the drawing is, along each side.
const FINE: u32 = 3;

/// A point of the finished picture: pixels to the right, pixels down.
pub type Pixel = (f64, f64);

/// The point of a text that its given position is that of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// Left end, half height.
    Left,
    /// Middle, half height.
    Centre,
    /// Right end, half height.
    Right,
}

/// The surface; made by [`paint`].
pub struct Canvas<'a> {
    backend: BitMapBackend<'a>,
}

/// Lets `draw` paint a picture of `width` by `height` pixels and writes it to `path`.
///
/// # Errors
///
/// If the drawing fails or the file cannot be written; either way no partial file
/// is left.
pub fn paint(
    path: &Path,
    width: u32,
    height: u32,
    draw: impl FnOnce(&mut Canvas<'_>) -> Result<(), ReportError>,
) -> Result<(), ReportError> {
    let size = (width * FINE, height * FINE);
    let mut rgb = vec![255; size.0 as usize * size.1 as usize * 3];
    draw(&mut Canvas {
        backend: BitMapBackend::with_buffer(&mut rgb, size),
    })?;
    png_file::save(path, width, height, &shrink(&rgb, width, height))?;
    Ok(())
}

impl Canvas<'_> {
    /// A line through `points` with round joints.
    pub fn line(
        &mut self,
        points: &[Pixel],
        colour: RGBColor,
        width: f64,
    ) -> Result<(), ReportError> {
        let pen = pen(colour, 1.0, width);
        // One segment at a time: a whole path is filled by the even-odd rule, which tears
        // holes wherever a noisy line crosses itself.
        for ends in points.windows(2) {
            let (from, to) = (grid(ends[0]), grid(ends[1]));
            if from != to {
                drawn(self.backend.draw_line(from, to, &pen))?;
            }
        }
        points
            .iter()
            .try_for_each(|&point| self.disc(point, width / 2.0, colour, 1.0))
    }

    /// A straight dashed line.
    pub fn dashes(
        &mut self,
        from: Pixel,
        to: Pixel,
        colour: RGBColor,
        width: f64,
    ) -> Result<(), ReportError> {
        const DASH: f64 = 9.0;
        const PERIOD: f64 = 15.0;
        let length = (to.0 - from.0).hypot(to.1 - from.1);
        let along = |distance: f64| {
            let part = (distance / length).min(1.0);
            (
                from.0 + part * (to.0 - from.0),
                from.1 + part * (to.1 - from.1),
            )
        };
        for dash in 0..(length / PERIOD).ceil() as u32 {
            let start = f64::from(dash) * PERIOD;
            self.line(&[along(start), along(start + DASH)], colour, width)?;
        }
        Ok(())
    }

    /// A filled circle; `opacity` 1 hides what is below.
    pub fn disc(
        &mut self,
        centre: Pixel,
        radius: f64,
        colour: RGBColor,
        opacity: f64,
    ) -> Result<(), ReportError> {
        let pen = pen(colour, opacity, 1.0);
        let radius = fine(radius) as u32;
        drawn(self.backend.draw_circle(grid(centre), radius, &pen, true))
    }

    /// A filled rectangle between two opposite corners.
    pub fn rectangle(
        &mut self,
        corner: Pixel,
        opposite: Pixel,
        colour: RGBColor,
    ) -> Result<(), ReportError> {
        let (corner, opposite) = (grid(corner), grid(opposite));
        let pen = pen(colour, 1.0, 1.0);
        drawn(self.backend.draw_rect(corner, opposite, &pen, true))
    }

    /// A picture, RGB, `width` pixels wide.
    pub fn picture(&mut self, corner: Pixel, width: usize, rgb: &[u8]) -> Result<(), ReportError> {
        for (number, pixel) in rgb.chunks_exact(3).enumerate() {
            let (x, y) = ((number % width) as f64, (number / width) as f64);
            let from = (corner.0 + x, corner.1 + y);
            let to = (from.0 + 1.0, from.1 + 1.0);
            self.rectangle(from, to, RGBColor(pixel[0], pixel[1], pixel[2]))?;
        }
        Ok(())
    }

    /// A filled shape with straight sides; where these cross, the even-odd rule decides.
    pub fn polygon(
        &mut self,
        corners: &[Pixel],
        colour: RGBColor,
        opacity: f64,
    ) -> Result<(), ReportError> {
        let corners: Vec<(i32, i32)> = corners.iter().map(|&corner| grid(corner)).collect();
        let heights = || corners.iter().map(|corner| corner.1);
        let top = heights().min().unwrap_or(0).max(0);
        let bottom = heights().max().unwrap_or(0);
        let bottom = bottom.min(self.backend.get_size().1 as i32);
        let pen = pen(colour, opacity, 1.0);
        for row in top..bottom {
            for ends in crossings(&corners, row).chunks_exact(2) {
                let (from, to) = ((ends[0], row), (ends[1], row + 1));
                drawn(self.backend.draw_rect(from, to, &pen, true))?;
            }
        }
        Ok(())
    }

    /// One line of text, `size` pixels high.
    pub fn text(
        &mut self,
        text: &str,
        at: Pixel,
        anchor: Anchor,
        size: f64,
        colour: RGBColor,
    ) -> Result<(), ReportError> {
        let line = font::line(text, fine(size) as f32)?;
        self.letters(&line, at, anchor, colour, |right, down| (right, down))
    }

    /// One line of text that reads upwards, centred on `at`.
    pub fn text_upwards(
        &mut self,
        text: &str,
        at: Pixel,
        size: f64,
        colour: RGBColor,
    ) -> Result<(), ReportError> {
        let line = font::line(text, fine(size) as f32)?;
        self.letters(&line, at, Anchor::Centre, colour, |right, down| {
            (down, -right)
        })
    }

    fn letters(
        &mut self,
        line: &font::Line,
        at: Pixel,
        anchor: Anchor,
        colour: RGBColor,
        turn: fn(i32, i32) -> (i32, i32),
    ) -> Result<(), ReportError> {
        let at = grid(at);
        let back = match anchor {
            Anchor::Left => 0.0,
            Anchor::Centre => line.width / 2.0,
            Anchor::Right => line.width,
        };
        for glyph in &line.glyphs {
            let corner = glyph.px_bounds().min;
            let corner = ((corner.x - back).round() as i32, corner.y.round() as i32);
            let mut outcome = Ok(());
            glyph.draw(|right, down, cover| {
                let (x, y) = turn(corner.0 + right as i32, corner.1 + down as i32);
                let ink = colour.mix(f64::from(cover)).to_backend_color();
                let pixel = self.backend.draw_pixel((at.0 + x, at.1 + y), ink);
                if pixel.is_err() {
                    outcome = drawn(pixel);
                }
            });
            outcome?;
        }
        Ok(())
    }
}

/// How wide a line of text is, in pixels.
pub fn text_width(text: &str, size: f64) -> Result<f64, ReportError> {
    let line = font::line(text, fine(size) as f32)?;
    Ok(f64::from(line.width) / f64::from(FINE))
}

/// Where the sides of a shape cross the middle of a row of pixels, from the left: the
/// first pixels whose middle lies beyond.
fn crossings(corners: &[(i32, i32)], row: i32) -> Vec<i32> {
    let middle = f64::from(row) + 0.5;
    let mut crossings: Vec<i32> = corners
        .iter()
        .zip(corners.iter().cycle().skip(1))
        .filter(|(from, to)| (from.1 <= row) != (to.1 <= row))
        .map(|(from, to)| {
            let part = (middle - f64::from(from.1)) / f64::from(to.1 - from.1);
            let x = f64::from(from.0) + part * f64::from(to.0 - from.0);
            (x - 0.5).ceil() as i32
        })
        .collect();
    crossings.sort_unstable();
    crossings
}

fn pen(colour: RGBColor, opacity: f64, width: f64) -> ShapeStyle {
    ShapeStyle {
        color: colour.mix(opacity),
        filled: true,
        stroke_width: fine(width).max(1) as u32,
    }
}

/// In pixels of the drawing; what lies absurdly far away stays far outside, but within
/// the range in which plotters can calculate.
fn fine(length: f64) -> i32 {
    const FAR: f64 = 1e6;
    (length * f64::from(FINE)).round().clamp(-FAR, FAR) as i32
}

fn grid(point: Pixel) -> (i32, i32) {
    (fine(point.0), fine(point.1))
}

fn drawn<T, E: std::fmt::Display>(result: Result<T, E>) -> Result<T, ReportError> {
    result.map_err(|error| ReportError::Draw(error.to_string()))
}

/// Averages every `FINE` by `FINE` block into one pixel of a `width` by `height` picture.
fn shrink(rgb: &[u8], width: u32, height: u32) -> Vec<u8> {
    let (width, height, fine) = (width as usize, height as usize, FINE as usize);
    let mut small = Vec::with_capacity(width * height * 3);
    let mut sums = vec![0_u32; width * 3];
    for block in rgb.chunks_exact(width * fine * 3 * fine) {
        sums.fill(0);
        for row in block.chunks_exact(width * fine * 3) {
            for (sum, pixels) in sums.chunks_exact_mut(3).zip(row.chunks_exact(fine * 3)) {
                for pixel in pixels.chunks_exact(3) {
                    sum.iter_mut()
                        .zip(pixel)
                        .for_each(|(sum, &value)| *sum += u32::from(value));
                }
            }
        }
        let area = FINE * FINE;
        small.extend(sums.iter().map(|sum| ((sum + area / 2) / area) as u8));
    }
    small
}
