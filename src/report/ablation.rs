//! Several methods' learning curves, each from several seeds, as the paper's figure 6.

use std::path::Path;

use plotters::style::RGBColor;

use super::ReportError;
use super::canvas::{Anchor, Canvas, Pixel, paint, text_width};
use super::chart::{self, Plot, PlotArea};
use super::learning_curve::{self, PANELS, Panel, Point};

/// One way to train, tried with several seeds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Method {
    /// A few words for the legend.
    pub name: String,
    /// Index of a colour, see [`chart::colour`].
    pub colour: usize,
    /// What training had reached at one moment after another, for each seed. The seeds
    /// need neither the same moments nor the same length.
    pub seeds: Vec<Vec<Point>>,
}

const PLOT: f64 = 440.0;
const HEIGHT: f64 = 360.0;
const LEFT: f64 = 116.0;
const GAP: f64 = 132.0;
const RIGHT: f64 = 36.0;
const WIDTH: f64 = LEFT + 3.0 * PLOT + 2.0 * GAP + RIGHT;
const TOP: f64 = 24.0;
const LEGEND_ROW: f64 = 38.0;
const LEGEND_GAP: f64 = 44.0;
/// The line before a name in the legend, and the room behind it.
const SWATCH: f64 = 58.0;
/// Room below the plots for the axis and the caption.
const BOTTOM: f64 = 136.0;

/// Intervals of the grid of steps that all seeds are compared on.
const INTERVALS: usize = 240;
/// Standard errors to each side of a mean that 95 % of repetitions would stay within.
const ERRORS: f64 = 1.96;
/// Fewer seeds than this have no standard error worth drawing.
const FEW: usize = 3;

/// Draws success, return and episode length side by side as a PNG: for each method the
/// mean over its seeds and a band. Each seed is smoothed first. Methods without data are
/// greyed in the legend.
///
/// # Errors
///
/// If the picture cannot be drawn or written.
pub fn draw(path: &Path, methods: &[Method]) -> Result<(), ReportError> {
    let steps = methods
        .iter()
        .flat_map(|method| method.seeds.iter().flatten());
    let end = learning_curve::rounded_end(steps.map(|point| point.steps));
    let panels: Vec<Vec<Curve>> = PANELS
        .iter()
        .map(|panel| {
            methods
                .iter()
                .map(|method| Curve::of(method, panel, end))
                .collect()
        })
        .collect();
    let names = names(methods, &panels);
    let places = place_names(&names)?;
    let rows = places.last().map_or(0, |&(_, row)| row + 1);
    let top = TOP + rows as f64 * LEGEND_ROW + 16.0;
    paint(
        path,
        WIDTH as u32,
        (top + HEIGHT + BOTTOM) as u32,
        |canvas| {
            for (name, &(left, row)) in names.iter().zip(&places) {
                name.draw(canvas, (LEFT + left, TOP + (row as f64 + 0.5) * LEGEND_ROW))?;
            }
            for (column, (panel, curves)) in PANELS.iter().zip(&panels).enumerate() {
                let left = LEFT + column as f64 * (PLOT + GAP);
                draw_panel(canvas, &plot(panel, curves, end, (left, top)), curves)?;
            }
            let at = (LEFT, top + HEIGHT + BOTTOM - 32.0);
            let caption = caption(panels.iter().flatten());
            canvas.text(&caption, at, Anchor::Left, chart::SMALL, chart::MUTED)
        },
    )
}

/// One method's curve of one quantity.
struct Curve {
    colour: RGBColor,
    /// Seeds with any values.
    seeds: usize,
    spots: Vec<Spot>,
}

/// What the seeds have at one number of steps.
struct Spot {
    steps: f64,
    mean: f64,
    low: f64,
    high: f64,
    /// Whether all seeds have a value here; a mean over others may jump.
    whole: bool,
}

impl Curve {
    fn of(method: &Method, panel: &Panel, end: f64) -> Self {
        let seeds: Vec<Vec<(f64, f64)>> = method
            .seeds
            .iter()
            .map(|points| learning_curve::smoothed(&panel.values(points), end))
            .filter(|seed| !seed.is_empty())
            .collect();
        let interval = end / INTERVALS as f64;
        let spots = (0..=INTERVALS).filter_map(|index| {
            let steps = index as f64 * interval;
            let near = |seed: &Vec<(f64, f64)>| {
                value_at(seed, steps, interval / 2.0).filter(|value| value.is_finite())
            };
            let values: Vec<f64> = seeds.iter().filter_map(near).collect();
            Spot::of(steps, &values, seeds.len())
        });
        Self {
            colour: chart::colour(method.colour),
            seeds: seeds.len(),
            spots: spots.collect(),
        }
    }

    fn has_band(&self) -> bool {
        self.seeds > 1 && self.spots.iter().any(|spot| spot.whole)
    }
}

impl Spot {
    fn of(steps: f64, values: &[f64], seeds: usize) -> Option<Self> {
        let (min, max) = chart::extent(values.iter().copied())?;
        let count = values.len() as f64;
        let mean = values.iter().map(|value| value / count).sum::<f64>();
        let (low, high) = if values.len() < FEW {
            (min, max)
        } else {
            let squares = values.iter().map(|value| (value - mean).powi(2));
            let variance = squares.sum::<f64>() / (count - 1.0);
            let reach = ERRORS * (variance / count).sqrt();
            (mean - reach, mean + reach)
        };
        Some(Self {
            steps,
            mean,
            low,
            high,
            whole: values.len() == seeds,
        })
    }
}

/// The curve's value between its points, or at its ends if these are within `near`.
fn value_at(curve: &[(f64, f64)], steps: f64, near: f64) -> Option<f64> {
    let (first, last) = (curve.first()?, curve.last()?);
    if steps < first.0 - near || steps > last.0 + near {
        return None;
    }
    let next = curve.partition_point(|point| point.0 < steps);
    let (Some(after), Some(before)) = (curve.get(next), curve.get(next.wrapping_sub(1))) else {
        return Some(if next == 0 { first.1 } else { last.1 });
    };
    let part = (steps - before.0) / (after.0 - before.0);
    Some(before.1 + part * (after.1 - before.1))
}

fn plot(panel: &Panel, curves: &[Curve], end: f64, (left, top): Pixel) -> Plot {
    let spots = curves.iter().flat_map(|curve| &curve.spots);
    let values = spots.flat_map(|spot| {
        if spot.whole {
            [spot.low, spot.high]
        } else {
            [spot.mean; 2]
        }
    });
    let limits = panel
        .limits
        .or_else(|| chart::extent(values).map(learning_curve::roomy));
    Plot {
        frame: PlotArea {
            left,
            top,
            right: left + PLOT,
            bottom: top + HEIGHT,
        },
        x: learning_curve::steps_axis(end, 6),
        y: chart::Axis::new(panel.label, limits.unwrap_or((0.0, 1.0)), 6),
    }
}

/// All bands below all lines.
fn draw_panel(canvas: &mut Canvas<'_>, plot: &Plot, curves: &[Curve]) -> Result<(), ReportError> {
    plot.draw_grid(canvas)?;
    plot.label_x(canvas)?;
    plot.label_y(canvas)?;
    if curves.iter().all(|curve| curve.spots.is_empty()) {
        return plot.remark(canvas, "no finished episodes yet");
    }
    for curve in curves {
        draw_band(canvas, plot, curve)?;
    }
    for curve in curves {
        draw_mean(canvas, plot, curve)?;
    }
    Ok(())
}

fn draw_band(canvas: &mut Canvas<'_>, plot: &Plot, curve: &Curve) -> Result<(), ReportError> {
    let whole = || curve.spots.iter().filter(|spot| spot.whole);
    let above = whole().map(|spot| place(plot, spot.steps, spot.high));
    let below = whole().rev().map(|spot| place(plot, spot.steps, spot.low));
    let outline: Vec<Pixel> = above.chain(below).collect();
    canvas.polygon(&outline, curve.colour, 0.22)
}

/// The line is thin where seeds are missing.
fn draw_mean(canvas: &mut Canvas<'_>, plot: &Plot, curve: &Curve) -> Result<(), ReportError> {
    let at = |spot: &Spot| place(plot, spot.steps, spot.mean);
    for ends in curve.spots.windows(2) {
        let whole = ends.iter().all(|spot| spot.whole);
        let width = if whole { 3.2 } else { 1.4 };
        canvas.line(&[at(&ends[0]), at(&ends[1])], curve.colour, width)?;
    }
    match curve.spots.last() {
        Some(last) => canvas.disc(at(last), 4.0, curve.colour, 1.0),
        None => Ok(()),
    }
}

fn place(plot: &Plot, steps: f64, value: f64) -> Pixel {
    plot.at(steps, value.clamp(plot.y.min, plot.y.max))
}

/// What the lines and the bands are.
fn caption<'a>(curves: impl Iterator<Item = &'a Curve> + Clone) -> String {
    let any = |of: fn(&Curve) -> bool| curves.clone().any(of);
    let bands = match (
        any(|curve| curve.has_band() && curve.seeds >= FEW),
        any(|curve| curve.has_band() && curve.seeds < FEW),
    ) {
        (true, true) => "; band: \u{b1} 1.96 standard errors, or min to max of fewer than 3 seeds",
        (true, false) => "; band: \u{b1} 1.96 standard errors",
        (false, true) => "; band: min to max of the seeds",
        (false, false) => "",
    };
    let thin = if any(|curve| curve.spots.iter().any(|spot| !spot.whole)) {
        "; thin: not all seeds have come that far"
    } else {
        ""
    };
    format!("line: mean over the seeds, each smoothed{bands}{thin}")
}

/// A method in the legend.
struct Name {
    text: String,
    line: RGBColor,
    ink: RGBColor,
}

fn names(methods: &[Method], panels: &[Vec<Curve>]) -> Vec<Name> {
    let name = |(index, method): (usize, &Method)| {
        let curves = panels.iter().map(|curves| &curves[index]);
        match curves.map(|curve| curve.seeds).max().unwrap_or(0) {
            0 => Name {
                text: format!("{} (no data)", method.name),
                line: chart::GRID,
                ink: chart::FRAME,
            },
            seeds => Name {
                text: format!(
                    "{} ({seeds} seed{})",
                    method.name,
                    if seeds == 1 { "" } else { "s" }
                ),
                line: chart::colour(method.colour),
                ink: chart::INK,
            },
        }
    };
    methods.iter().enumerate().map(name).collect()
}

/// Left end and row of each name.
fn place_names(names: &[Name]) -> Result<Vec<(f64, usize)>, ReportError> {
    let width = |name: &Name| Ok(SWATCH + text_width(&name.text, chart::NORMAL)?);
    let widths: Vec<f64> = names
        .iter()
        .map(width)
        .collect::<Result<_, ReportError>>()?;
    Ok(chart::flow(&widths, LEGEND_GAP, WIDTH - LEFT - RIGHT))
}

impl Name {
    /// From the left end at half height.
    fn draw(&self, canvas: &mut Canvas<'_>, (left, y): Pixel) -> Result<(), ReportError> {
        let right = left + SWATCH - 14.0;
        let (corner, opposite) = ((left, y - 10.0), (right, y + 10.0));
        canvas.rectangle(corner, opposite, chart::tint(self.line, 0.22))?;
        canvas.line(&[(left, y), (right, y)], self.line, 3.2)?;
        let at = (left + SWATCH, y);
        canvas.text(&self.text, at, Anchor::Left, chart::NORMAL, self.ink)
    }
}
