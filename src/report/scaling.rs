//! Speed by size on logarithmic axes: how what was measured scales.

use std::path::Path;

use super::ReportError;
use super::canvas::{Anchor, Canvas, paint, text_width};
use super::chart::{self, Axis, Plot, PlotArea};

/// One plot.
pub struct ScalingPanel {
    /// Title of the panel.
    pub title: String,
    /// What grows, and what is measured, with its unit.
    pub x: &'static str,
    /// Label of the vertical axis.
    pub y: &'static str,
    /// Curves, a device each.
    pub curves: Vec<Curve>,
}

/// One curve of positive numbers.
pub struct Curve {
    /// A few words for the legend; the same in each panel of the same colour.
    pub name: String,
    /// Size and speed, by rising size.
    pub points: Vec<(f64, f64)>,
}

const PLOT: f64 = 460.0;
const HEIGHT: f64 = 380.0;
const LEFT: f64 = 120.0;
const GAP: f64 = 132.0;
const RIGHT: f64 = 40.0;
const TOP: f64 = 24.0;
const LEGEND_ROW: f64 = 38.0;
const LEGEND_GAP: f64 = 44.0;
const SWATCH: f64 = 58.0;
const TITLE: f64 = 48.0;
const BOTTOM: f64 = 88.0;

/// Draws the panels side by side as a PNG.
///
/// # Errors
///
/// If the picture cannot be drawn or written.
pub fn draw(path: &Path, panels: &[ScalingPanel]) -> Result<(), ReportError> {
    let mut names: Vec<&str> = Vec::new();
    for curve in panels.iter().flat_map(|panel| &panel.curves) {
        if !names.contains(&curve.name.as_str()) {
            names.push(&curve.name);
        }
    }
    let width = LEFT + panels.len() as f64 * (PLOT + GAP) - GAP + RIGHT;
    let widths = names
        .iter()
        .map(|name| Ok(SWATCH + text_width(name, chart::NORMAL)?))
        .collect::<Result<Vec<_>, ReportError>>()?;
    let places = chart::flow(&widths, LEGEND_GAP, width - LEFT - RIGHT);
    let rows = places.last().map_or(0, |&(_, row)| row + 1);
    let top = TOP + rows as f64 * LEGEND_ROW + TITLE;
    let height = top + HEIGHT + BOTTOM;
    paint(path, width as u32, height as u32, |canvas| {
        for (index, (name, &(left, row))) in names.iter().zip(&places).enumerate() {
            let (x, y) = (LEFT + left, TOP + (row as f64 + 0.5) * LEGEND_ROW);
            canvas.line(&[(x, y), (x + 44.0, y)], chart::colour(index), 4.0)?;
            let at = (x + SWATCH, y);
            canvas.text(name, at, Anchor::Left, chart::NORMAL, chart::INK)?;
        }
        for (column, panel) in panels.iter().enumerate() {
            let left = LEFT + column as f64 * (PLOT + GAP);
            panel.draw(canvas, (left, top), &names)?;
        }
        Ok(())
    })
}

impl ScalingPanel {
    fn draw(
        &self,
        canvas: &mut Canvas<'_>,
        at: (f64, f64),
        names: &[&str],
    ) -> Result<(), ReportError> {
        let points = || self.curves.iter().flat_map(|curve| &curve.points);
        let plot = Plot {
            frame: PlotArea {
                left: at.0,
                top: at.1,
                right: at.0 + PLOT,
                bottom: at.1 + HEIGHT,
            },
            x: axis(self.x, points().map(|point| point.0)),
            y: axis(self.y, points().map(|point| point.1)),
        };
        plot.draw_grid(canvas)?;
        plot.label_x(canvas)?;
        plot.label_y(canvas)?;
        let above = (at.0, at.1 - 24.0);
        canvas.text(&self.title, above, Anchor::Left, chart::NORMAL, chart::INK)?;
        for curve in &self.curves {
            let index = names.iter().position(|name| *name == curve.name);
            let colour = chart::colour(index.unwrap_or(0));
            let places = curve.points.iter();
            let line: Vec<_> = places.map(|p| plot.at(p.0.log10(), p.1.log10())).collect();
            canvas.line(&line, colour, 3.0)?;
            for &at in &line {
                canvas.disc(at, 5.0, colour, 1.0)?;
            }
        }
        Ok(())
    }
}

/// An axis of logarithms, over whole powers of ten.
fn axis(label: &'static str, values: impl Iterator<Item = f64>) -> Axis {
    let (min, max) = chart::extent(values.map(f64::log10)).unwrap_or((0.0, 1.0));
    let (min, max) = (min.floor(), max.ceil().max(min.floor() + 1.0));
    Axis {
        min,
        max,
        ticks: (min as i32..=max as i32).map(f64::from).collect(),
        lines: Vec::new(),
        label,
        format: |power| chart::steps(10f64.powf(power)),
    }
}
