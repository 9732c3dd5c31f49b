//! Learning curves: success, return and length of episodes over environment steps,
//! laid out as the paper's figures 4 and 5.

use std::path::Path;

use plotters::style::RGBColor;

use super::ReportError;
use super::canvas::{Anchor, Canvas, Pixel, paint, text_width};
use super::chart::{self, Axis, Plot, PlotArea};

mod levels;

pub use levels::Level;

/// What training had reached at one moment. Values that are missing or not finite are
/// left out of the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point {
    /// Environment steps taken so far.
    pub steps: u64,
    /// Training time so far, in seconds.
    pub wall_s: f64,
    /// Share of the finished episodes that reached the target, 0 to 1.
    pub success: Option<f64>,
    /// Mean undiscounted return of the finished episodes.
    pub episode_return: Option<f64>,
    /// Mean length of the finished episodes, in steps.
    pub episode_length: Option<f64>,
    /// Share of the finished episodes that ended by a fall, 0 to 1.
    pub fall: Option<f64>,
    /// Mean style reward of a step.
    pub style_reward: Option<f64>,
    /// Weight of the task's reward beside that of the style, 0 to 1, where a rule finds it.
    pub task_weight: Option<f64>,
    /// Share of the recorded windows that the discriminator took for such, 0 to 1.
    pub recorded_accuracy: Option<f64>,
    /// Share of the agents' windows that it took for such, 0 to 1.
    pub agent_accuracy: Option<f64>,
}

/// A dashed vertical line at a moment worth naming.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mark {
    /// Environment steps taken by then.
    pub steps: u64,
    /// A few words above the line, such as "20k · 30 s"; may be empty.
    pub label: String,
    /// Index into [`chart::PALETTE`].
    pub colour: usize,
}

const WIDTH: f64 = 1600.0;
const LEFT: f64 = 120.0;
const RIGHT: f64 = 116.0;
const TOP: f64 = 24.0;
const PANEL: f64 = 270.0;
const GAP: f64 = 34.0;
/// Room below the panels for the two axes.
const BOTTOM: f64 = 168.0;
const LABEL_ROW: f64 = 30.0;
const LABEL_ROWS: usize = 5;
/// From a line of small text to the next.
const LINE: f64 = 28.0;

const CURVE: RGBColor = RGBColor(0x1e, 0x3a, 0x5f);

/// One quantity over the steps, or two of one axis.
pub(super) struct Panel {
    pub label: &'static str,
    pub value: fn(&Point) -> Option<f64>,
    beside: Option<Beside>,
    /// A few words at the bottom.
    note: Option<&'static str>,
    /// The axis, where the quantity itself sets its limits.
    pub limits: Option<(f64, f64)>,
    /// How the last value is written beside the curve.
    format: fn(f64) -> String,
}

impl Panel {
    /// The finite values with their steps.
    pub fn values(&self, points: &[Point]) -> Vec<(f64, f64)> {
        values(self.value, points)
    }
}

/// A second quantity of a panel.
pub(super) struct Beside {
    value: fn(&Point) -> Option<f64>,
    /// Names of both, the panel's own first.
    names: [&'static str; 2],
}

fn values(value: fn(&Point) -> Option<f64>, points: &[Point]) -> Vec<(f64, f64)> {
    points
        .iter()
        .filter_map(|point| Some((point.steps as f64, value(point)?)))
        .filter(|(_, value)| value.is_finite())
        .collect()
}

pub(super) const PANELS: [Panel; 3] = [
    Panel {
        label: "success (%)",
        value: |point| point.success.map(|share| 100.0 * share),
        beside: None,
        note: None,
        limits: Some((0.0, 104.0)),
        format: percent,
    },
    Panel {
        label: "episode return",
        value: |point| point.episode_return,
        beside: None,
        note: None,
        limits: None,
        format: brief,
    },
    Panel {
        label: "episode length (steps)",
        value: |point| point.episode_length,
        beside: None,
        note: None,
        limits: None,
        format: brief,
    },
];

/// What a training with a discriminator has besides.
const STYLE_PANELS: [Panel; 3] = [
    Panel {
        label: "style reward a step",
        value: |point| point.style_reward,
        beside: None,
        note: None,
        limits: None,
        format: brief,
    },
    Panel {
        label: "recognised (%)",
        value: |point| point.agent_accuracy.map(|share| 100.0 * share),
        beside: Some(Beside {
            value: |point| point.recorded_accuracy.map(|share| 100.0 * share),
            names: ["agents", "recordings"],
        }),
        note: None,
        limits: Some((0.0, 104.0)),
        format: percent,
    },
    Panel {
        label: "falls (%)",
        value: |point| point.fall.map(|share| 100.0 * share),
        beside: None,
        note: None,
        limits: Some((0.0, 104.0)),
        format: percent,
    },
];

/// Besides, where a rule finds the weights of task and style: the paper's figure 7.
const WEIGHT_PANEL: Panel = Panel {
    label: "weight of the task",
    value: |point| point.task_weight,
    beside: None,
    note: Some("PD rule, our constants"),
    limits: Some((0.0, 1.0)),
    format: brief,
};

/// The panels of a training: those of every one, and those of its style, if it has one.
fn panels(points: &[Point]) -> Vec<&'static Panel> {
    let any = |of: fn(&Point) -> bool| points.iter().any(of);
    let styled = any(|point| point.style_reward.is_some());
    let weighed = any(|point| point.task_weight.is_some());
    let weight = weighed.then_some(&WEIGHT_PANEL);
    let style = STYLE_PANELS.iter().filter(|_| styled);
    PANELS.iter().chain(weight).chain(style).collect()
}

/// Draws the curves, with `marks` and the beginnings of `levels` through all panels, as a
/// PNG. A task without a curriculum has no `levels`.
///
/// # Errors
///
/// If the picture cannot be drawn or written.
pub fn draw(
    path: &Path,
    points: &[Point],
    marks: &[Mark],
    levels: &[Level],
) -> Result<(), ReportError> {
    let end = rounded_end(points.iter().map(|point| point.steps));
    let numbers = levels::place_numbers(levels, end, [LEFT, WIDTH - RIGHT])?;
    let labels = place_labels(marks, end, usize::from(!numbers.is_empty()))?;
    let rows = labels.iter().map(|label| label.row + 1).max();
    let rows = rows.unwrap_or(usize::from(!numbers.is_empty()));
    let top = TOP + rows as f64 * LABEL_ROW;
    let panels = panels(points);
    let count = panels.len() as f64;
    let height = top + count * PANEL + (count - 1.0) * GAP + BOTTOM;
    paint(path, WIDTH as u32, height as u32, |canvas| {
        for (index, panel) in panels.iter().enumerate() {
            let plot = plot(panel, points, end, top + index as f64 * (PANEL + GAP));
            plot.draw_grid(canvas)?;
            plot.label_y(canvas)?;
            levels::draw_lines(canvas, &plot, levels)?;
            draw_panel(canvas, panel, &plot, points, marks)?;
            if index + 1 == panels.len() {
                plot.label_x(canvas)?;
                draw_time(canvas, &plot, points)?;
            }
        }
        levels::draw_numbers(canvas, &numbers, (LEFT, top - 0.5 * LABEL_ROW))?;
        labels.iter().try_for_each(|label| {
            let at = (label.middle, top - (label.row as f64 + 0.5) * LABEL_ROW);
            let colour = chart::colour(label.mark.colour);
            canvas.text(&label.mark.label, at, Anchor::Centre, chart::SMALL, colour)
        })
    })
}

/// Where the axis of steps ends: at the last step, or at the next round number if that
/// is so near that the axis would only just miss it.
pub(super) fn rounded_end(steps: impl Iterator<Item = u64>) -> f64 {
    let last = steps.max().unwrap_or(0).max(1) as f64;
    chart::ticks(last, 1.01 * last, 1)
        .first()
        .map_or(last, |&round| round.max(last))
}

fn plot(panel: &Panel, points: &[Point], end: f64, top: f64) -> Plot {
    let limits = panel.limits.unwrap_or_else(|| {
        chart::extent(points.iter().filter_map(panel.value)).map_or((0.0, 1.0), roomy)
    });
    Plot {
        frame: PlotArea {
            left: LEFT,
            top,
            right: WIDTH - RIGHT,
            bottom: top + PANEL,
        },
        x: steps_axis(end, 11),
        y: Axis::new(panel.label, limits, 6),
    }
}

/// The axis of steps with at most `count` numbers along it.
pub(super) fn steps_axis(end: f64, count: usize) -> Axis {
    let mut axis = Axis::new("environment steps", (0.0, end), count);
    axis.format = chart::steps;
    axis
}

/// A little more than the values need, down to zero where they come near it.
pub(super) fn roomy((min, max): (f64, f64)) -> (f64, f64) {
    let span = max - min;
    let room = if span > 0.0 {
        0.06 * span
    } else {
        (0.1 * max.abs()).max(1.0)
    };
    let bottom = if min >= 0.0 && min < span {
        0.0
    } else {
        min - room
    };
    (bottom, max + room)
}

/// The raw values below the marks, the smooth curve above them.
fn draw_panel(
    canvas: &mut Canvas<'_>,
    panel: &Panel,
    plot: &Plot,
    points: &[Point],
    marks: &[Mark],
) -> Result<(), ReportError> {
    if let Some(beside) = &panel.beside {
        let raw = values(beside.value, points);
        draw_line(canvas, panel, plot, &raw, &[], chart::colour(1), LINE)?;
        let colours = [CURVE, chart::colour(1)];
        for (row, (name, colour)) in beside.names.iter().zip(colours).enumerate() {
            let at = (
                plot.frame.left + 14.0,
                plot.frame.bottom - 24.0 - LINE * row as f64,
            );
            canvas.text(name, at, Anchor::Left, chart::SMALL, colour)?;
        }
    }
    if let Some(note) = panel.note {
        let at = (plot.frame.left + 14.0, plot.frame.bottom - 24.0);
        canvas.text(note, at, Anchor::Left, chart::SMALL, chart::MUTED)?;
    }
    let raw = panel.values(points);
    if raw.is_empty() {
        draw_marks(canvas, plot, marks)?;
        return plot.remark(canvas, "no finished episodes yet");
    }
    draw_line(canvas, panel, plot, &raw, marks, CURVE, 0.0)
}

/// Draws a line whose last value is written so many pixels below its end.
fn draw_line(
    canvas: &mut Canvas<'_>,
    panel: &Panel,
    plot: &Plot,
    raw: &[(f64, f64)],
    marks: &[Mark],
    colour: RGBColor,
    below: f64,
) -> Result<(), ReportError> {
    let smooth = smoothed(raw, plot.x.max);
    let place = |&(x, y): &(f64, f64)| plot.at(x, y.clamp(plot.y.min, plot.y.max));
    let line: Vec<Pixel> = raw.iter().map(place).collect();
    canvas.line(&line, chart::tint(colour, 0.25), 1.3)?;
    draw_marks(canvas, plot, marks)?;
    let line: Vec<Pixel> = smooth.iter().map(place).collect();
    canvas.line(&line, colour, 3.2)?;
    let Some(last) = smooth.last() else {
        return Ok(());
    };
    let (x, y) = place(last);
    canvas.disc((x, y), 5.0, colour, 1.0)?;
    let text = (panel.format)(last.1);
    let at = (x + 14.0, y + below);
    canvas.text(&text, at, Anchor::Left, chart::SMALL, colour)
}

/// Averages weighted by a bell curve, whose standard deviation is a small part of the
/// axis of steps up to `end`.
///
/// `values` must be sorted by x, as a training's log is; the neighbourhoods are then
/// found in one sweep.
pub(super) fn smoothed(values: &[(f64, f64)], end: f64) -> Vec<(f64, f64)> {
    let width = end / 120.0;
    let reach = 3.0 * width;
    let mut start = 0;
    values
        .iter()
        .map(|&(x, _)| {
            start += values[start..]
                .iter()
                .take_while(|near| near.0 < x - reach)
                .count();
            let (sum, weights) = values[start..]
                .iter()
                .take_while(|near| near.0 <= x + reach)
                .map(|&(near, y)| ((-0.5 * ((near - x) / width).powi(2)).exp(), y))
                .fold((0.0, 0.0), |(sum, weights), (weight, y)| {
                    (sum + weight * y, weights + weight)
                });
            (x, sum / weights)
        })
        .collect()
}

fn draw_marks(canvas: &mut Canvas<'_>, plot: &Plot, marks: &[Mark]) -> Result<(), ReportError> {
    for mark in marks {
        if mark.steps as f64 <= plot.x.max {
            let (x, _) = plot.at(mark.steps as f64, plot.y.min);
            let (top, bottom) = (plot.frame.top, plot.frame.bottom);
            canvas.dashes((x, top), (x, bottom), chart::colour(mark.colour), 2.0)?;
        }
    }
    Ok(())
}

/// A mark's label and its position above the panels.
struct Label<'a> {
    mark: &'a Mark,
    /// Its middle, in pixels from the left.
    middle: f64,
    /// 0 is the row next to the panels.
    row: usize,
}

/// Puts each label above its line, in the lowest row from `first` on in which it is clear
/// of the labels before it; a label that finds no room is left out.
fn place_labels(marks: &[Mark], end: f64, first: usize) -> Result<Vec<Label<'_>>, ReportError> {
    let mut sorted: Vec<&Mark> = marks
        .iter()
        .filter(|mark| !mark.label.is_empty() && mark.steps as f64 <= end)
        .collect();
    sorted.sort_by_key(|mark| mark.steps);
    let mut taken = [f64::NEG_INFINITY; LABEL_ROWS];
    let mut labels = Vec::with_capacity(sorted.len());
    for mark in sorted {
        let (left, right) = (LEFT, WIDTH - RIGHT);
        let half = text_width(&mark.label, chart::SMALL)? / 2.0;
        let x = left + (right - left) * mark.steps as f64 / end;
        let middle = x.min(right - half).max(left + half);
        if let Some(row) = taken.iter().position(|&taken| taken < middle - half) {
            taken[row] = middle + half + 16.0;
            let row = first + row;
            labels.push(Label { mark, middle, row });
        }
    }
    Ok(labels)
}

/// A second axis below the steps: the training time at which they were reached.
fn draw_time(canvas: &mut Canvas<'_>, plot: &Plot, points: &[Point]) -> Result<(), ReportError> {
    let mut clock: Vec<(f64, f64)> = vec![(0.0, 0.0)];
    for point in points {
        let (steps, time) = clock.last().copied().unwrap_or_default();
        if point.wall_s.is_finite() && point.wall_s > time && point.steps as f64 > steps {
            clock.push((point.steps as f64, point.wall_s));
        }
    }
    if clock.len() < 2 {
        return Ok(());
    }
    let interval = interval(clock.last().map_or(0.0, |last| last.1));
    let PlotArea {
        left,
        right,
        bottom,
        ..
    } = plot.frame;
    let y = bottom + 88.0;
    canvas.line(&[(left, y), (right, y)], chart::FRAME, 1.2)?;
    let mut next = 0.0;
    for ends in clock.windows(2) {
        let ((from, start), (to, end)) = (ends[0], ends[1]);
        while next <= end {
            let steps = from + (to - from) * (next - start) / (end - start);
            let (x, _) = plot.at(steps, plot.y.min);
            canvas.line(&[(x, y), (x, y + 7.0)], chart::FRAME, 1.2)?;
            let (text, at) = (duration(next), (x, y + 24.0));
            canvas.text(&text, at, Anchor::Centre, chart::SMALL, chart::MUTED)?;
            next += interval;
        }
    }
    let at = ((left + right) / 2.0, y + 56.0);
    canvas.text(
        "training time",
        at,
        Anchor::Centre,
        chart::NORMAL,
        chart::INK,
    )
}

/// A round interval, in seconds, that fits at most about ten times into `total`.
fn interval(total: f64) -> f64 {
    const ROUND: [f64; 14] = [
        1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 60.0, 120.0, 300.0, 600.0, 900.0, 1800.0, 3600.0, 7200.0,
    ];
    let least = total / 10.0;
    let hours = (least / 14400.0).ceil() * 14400.0;
    ROUND
        .into_iter()
        .find(|&round| round >= least)
        .unwrap_or(hours)
}

fn duration(seconds: f64) -> String {
    let seconds = seconds.round() as u64;
    let (hours, minutes, rest) = (seconds / 3600, seconds / 60 % 60, seconds % 60);
    match (hours, minutes, rest) {
        (0, 0, _) => format!("{rest} s"),
        (0, _, 0) => format!("{minutes} min"),
        (0, _, _) => format!("{minutes}:{rest:02} min"),
        (_, 0, _) => format!("{hours} h"),
        (_, _, _) => format!("{hours}:{minutes:02} h"),
    }
}

fn percent(value: f64) -> String {
    format!("{value:.1} %")
}

/// Three or four digits, as many as are worth reading.
fn brief(value: f64) -> String {
    let factor = if value.abs() < 100.0 { 100.0 } else { 1.0 };
    chart::number((value * factor).round() / factor)
}
