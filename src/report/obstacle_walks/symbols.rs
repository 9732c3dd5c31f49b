//! Colours and symbols of the panels, the maps and the legend.

use crate::report::ReportError;
use crate::report::canvas::{Canvas, Pixel};
use crate::report::chart;
use plotters::style::RGBColor;

pub const OBSTACLE: RGBColor = RGBColor(0x64, 0x74, 0x8b);
pub const WAY: RGBColor = RGBColor(0x94, 0xa0, 0xb0);
pub const SEEN: RGBColor = chart::PALETTE[3];

/// The point so many pixels ahead and to the right of someone who stands `at` a point
/// and looks `forward`.
pub fn turned(at: Pixel, forward: Pixel, ahead: f64, right: f64) -> Pixel {
    let (x, y) = forward;
    (at.0 + ahead * x - right * y, at.1 + ahead * y + right * x)
}

/// An obstacle between two opposite corners.
pub fn draw_rectangle(
    canvas: &mut Canvas<'_>,
    corner: Pixel,
    opposite: Pixel,
    colour: RGBColor,
) -> Result<(), ReportError> {
    canvas.rectangle(corner, opposite, chart::tint(colour, 0.2))?;
    draw_outline(canvas, corner, opposite, chart::tint(colour, 0.6), 1.2)
}

/// The outline of a rectangle.
pub fn draw_outline(
    canvas: &mut Canvas<'_>,
    corner: Pixel,
    opposite: Pixel,
    colour: RGBColor,
    width: f64,
) -> Result<(), ReportError> {
    let others = [(opposite.0, corner.1), (corner.0, opposite.1)];
    let line = [corner, others[0], opposite, others[1], corner];
    canvas.line(&line, colour, width)
}

/// The character, seen from above.
pub fn draw_arrow(canvas: &mut Canvas<'_>, at: Pixel, forward: Pixel) -> Result<(), ReportError> {
    let corner = |ahead, right| turned(at, forward, ahead, right);
    let arrow = [
        corner(14.0, 0.0),
        corner(-9.0, 9.0),
        corner(-4.0, 0.0),
        corner(-9.0, -9.0),
        corner(14.0, 0.0),
    ];
    canvas.line(&arrow, chart::tint(SEEN, 0.0), 4.0)?;
    canvas.polygon(&arrow, SEEN, 1.0)
}
