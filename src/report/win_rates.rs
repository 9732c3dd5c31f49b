//! Who beats whom, as a matrix of coloured cells.

use std::path::Path;

use super::ReportError;
use super::canvas::{Anchor, paint, text_width};
use super::chart;

const CELL: f64 = 84.0;
const GAP: f64 = 18.0;
const MARGIN: f64 = 30.0;
const TITLE: f64 = 64.0;
const NUMBER: f64 = 44.0;

/// Draws the percents of bouts that the player of a row won against that of a column, as a PNG; players are told by
/// number along the columns. `rates` are fractions, `[players][players]`.
///
/// # Errors
///
/// If the picture cannot be drawn or written.
pub fn draw(path: &Path, names: &[String], rates: &[Vec<Option<f64>>]) -> Result<(), ReportError> {
    let labels: Vec<String> = names
        .iter()
        .enumerate()
        .map(|(number, name)| format!("{}  {name}", number + 1))
        .collect();
    let mut left = 0.0f64;
    for label in &labels {
        left = left.max(MARGIN + text_width(label, chart::SMALL)? + GAP);
    }
    let side = CELL * names.len() as f64;
    let top = MARGIN + TITLE + NUMBER;
    let width = (left + side).max(left + 420.0) + MARGIN;
    paint(path, width as u32, (top + side + MARGIN) as u32, |canvas| {
        let title = "% of bouts won against";
        let at = (left, MARGIN + TITLE / 2.0);
        canvas.text(title, at, Anchor::Left, chart::NORMAL, chart::INK)?;
        for (one, label) in labels.iter().enumerate() {
            let middle = (one as f64 + 0.5) * CELL;
            let at = (left - GAP, top + middle);
            canvas.text(label, at, Anchor::Right, chart::SMALL, chart::INK)?;
            let (number, at) = ((one + 1).to_string(), (left + middle, top - NUMBER / 2.0));
            canvas.text(&number, at, Anchor::Centre, chart::SMALL, chart::MUTED)?;
            for (other, rate) in rates[one].iter().enumerate() {
                let Some(rate) = rate else { continue };
                let (x, y) = (left + CELL * other as f64, top + CELL * one as f64);
                let colour = chart::tint(chart::colour(0), *rate);
                canvas.rectangle((x + 1.0, y + 1.0), (x + CELL - 1.0, y + CELL - 1.0), colour)?;
                let text = format!("{:.0}", 100.0 * rate);
                let at = (x + CELL / 2.0, y + CELL / 2.0);
                canvas.text(&text, at, Anchor::Centre, chart::SMALL, chart::INK)?;
            }
        }
        Ok(())
    })
}
