//! The obstacle maps beside an episode's panel.

use super::episode::{CELLS, DrawnEpisode, Map, seconds};
use super::symbols::{OBSTACLE, SEEN, draw_arrow, draw_outline};
use crate::report::ReportError;
use crate::report::canvas::{Anchor, Canvas, Pixel};
use crate::report::chart;

const CELL: f64 = 15.0;
/// Width and height of a map, in pixels.
pub const SIDE: f64 = CELL * CELLS as f64;
/// From the lower end of one map to that of the other.
const APART: f64 = 280.0;

/// Draws the maps observed at the moment, above, and a step before, below. The lower one ends at
/// `bottom`.
pub fn draw(
    canvas: &mut Canvas<'_>,
    episode: &DrawnEpisode,
    step_s: f32,
    (left, bottom): Pixel,
) -> Result<(), ReportError> {
    let now = episode.seen;
    let titles = [
        format!("seen at {}", seconds(now, step_s)),
        format!("and at {}", seconds(now.saturating_sub(1), step_s)),
    ];
    for (index, (map, title)) in episode.maps.iter().zip(&titles).enumerate() {
        let bottom = bottom - (1 - index) as f64 * APART;
        let at = (left, bottom - SIDE - 20.0);
        canvas.text(title, at, Anchor::Left, chart::NORMAL, SEEN)?;
        draw_map(canvas, map, (left, bottom - SIDE))?;
    }
    let at = (left + SIDE / 2.0, bottom + 22.0);
    let text = "6 m \u{d7} 6 m, ahead is up";
    canvas.text(text, at, Anchor::Centre, chart::SMALL, chart::MUTED)
}

fn draw_map(canvas: &mut Canvas<'_>, map: &Map, (left, top): Pixel) -> Result<(), ReportError> {
    let (right, bottom) = (left + SIDE, top + SIDE);
    for (row, cells) in map.iter().enumerate() {
        for (column, &cell) in cells.iter().enumerate().filter(|&(_, &cell)| cell > 0) {
            let (x, y) = (right - column as f64 * CELL, bottom - row as f64 * CELL);
            canvas.rectangle(
                (x - CELL, y - CELL),
                (x, y),
                chart::tint(OBSTACLE, 0.75 * f64::from(cell) / 255.0),
            )?;
        }
    }
    for line in 1..CELLS {
        let along = line as f64 * CELL;
        let (x, y) = (left + along, top + along);
        canvas.line(&[(x, top), (x, bottom)], chart::GRID, 1.0)?;
        canvas.line(&[(left, y), (right, y)], chart::GRID, 1.0)?;
    }
    draw_outline(canvas, (left, top), (right, bottom), SEEN, 1.6)?;
    draw_arrow(canvas, (left + SIDE / 2.0, top + SIDE / 2.0), (0.0, -1.0))
}
