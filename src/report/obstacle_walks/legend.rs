//! The legend of the symbols in the panels.

use super::symbols::{OBSTACLE, SEEN, WAY, draw_arrow, draw_outline, draw_rectangle};
use crate::report::ReportError;
use crate::report::canvas::{Anchor, Canvas, Pixel, text_width};
use crate::report::{chart, ground};

const SYMBOL: f64 = 46.0;
const ROW: f64 = 36.0;
const GAP: f64 = 30.0;

/// A symbol of the legend.
enum Symbol {
    Obstacle,
    Way,
    Start,
    Second,
    Target,
    Seen,
}

const LEGEND: [(Symbol, &str); 6] = [
    (Symbol::Obstacle, "obstacle at the end"),
    (Symbol::Way, "its way there"),
    (Symbol::Start, "start"),
    (Symbol::Second, "each second"),
    (Symbol::Target, "target"),
    (
        Symbol::Seen,
        "character when it saw the maps, and what they cover",
    ),
];

/// Left end, in pixels, and row of each item, no row wider than `room`.
pub fn place(room: f64) -> Result<Vec<(f64, usize)>, ReportError> {
    let width = |(_, text): &(Symbol, &str)| Ok(SYMBOL + text_width(text, chart::SMALL)?);
    let widths: Vec<f64> = LEGEND
        .iter()
        .map(width)
        .collect::<Result<_, ReportError>>()?;
    Ok(chart::flow(&widths, GAP, room))
}

/// The room that the placed items need, in pixels.
pub fn height(places: &[(f64, usize)]) -> f64 {
    let rows = places.last().map_or(0, |&(_, row)| row + 1);
    (rows as f64 + 0.5) * ROW
}

/// Draws the placed items, to the right of and below a point.
pub fn draw(
    canvas: &mut Canvas<'_>,
    places: &[(f64, usize)],
    (left, top): Pixel,
) -> Result<(), ReportError> {
    for (item, &(right, row)) in LEGEND.iter().zip(places) {
        let at = (left + right, top + (row as f64 + 0.5) * ROW);
        draw_item(canvas, item, at)?;
    }
    Ok(())
}

/// An item of the legend, from its left end at half height.
fn draw_item(
    canvas: &mut Canvas<'_>,
    (symbol, text): &(Symbol, &str),
    (left, y): Pixel,
) -> Result<(), ReportError> {
    let (middle, right) = (left + 18.0, left + 36.0);
    match symbol {
        Symbol::Obstacle => {
            let (corner, opposite) = ((middle - 16.0, y - 10.0), (middle + 16.0, y + 10.0));
            draw_rectangle(canvas, corner, opposite, OBSTACLE)?;
        }
        Symbol::Way => {
            canvas.line(&[(left, y), (right, y)], WAY, 1.2)?;
            canvas.disc((right, y), 2.4, WAY, 1.0)?;
        }
        Symbol::Start => ground::start(canvas, (middle, y))?,
        Symbol::Second => {
            canvas.line(&[(left, y), (right, y)], chart::INK, 3.0)?;
            canvas.disc((middle, y), 5.0, chart::INK, 1.0)?;
        }
        Symbol::Target => {
            canvas.disc((middle, y), 12.0, chart::INK, 0.14)?;
            ground::circle(canvas, (middle, y), 12.0, chart::INK, true)?;
        }
        Symbol::Seen => {
            let (corner, opposite) = ((middle - 16.0, y - 16.0), (middle + 16.0, y + 16.0));
            draw_outline(canvas, corner, opposite, SEEN, 1.6)?;
            draw_arrow(canvas, (middle, y), (0.0, -1.0))?;
        }
    }
    let at = (left + SYMBOL, y);
    canvas.text(text, at, Anchor::Left, chart::SMALL, chart::INK)
}
