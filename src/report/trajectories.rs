//! Paths to their targets, seen from above: one panel for each stage of a training, as
//! in the paper's figure 4 (c).

use super::ReportError;
use super::canvas::{Anchor, Canvas, Pixel, paint, text_width};
use super::chart::{self, Plot, PlotArea};
use super::ground;

/// One episode, on the way to one target.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Path {
    /// The root's ground positions in order of time: world x and z, in metres. Points
    /// that are not finite are left out.
    pub points: Vec<[f32; 2]>,
    /// World x and z of the target, in metres.
    pub target: [f32; 2],
    /// Whether the character came within the target's circle. If not, the circle is dashed
    /// and a cross marks where the episode ended.
    pub reached: bool,
    /// A few letters beside the target, such as the time to it: "2.4 s".
    pub label: String,
    /// Index into [`chart::PALETTE`].
    pub colour: usize,
}

/// The episodes of one panel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Group {
    /// What the panel shows, such as "20k steps".
    pub title: String,
    /// The paths of its episodes.
    pub paths: Vec<Path>,
}

const COLUMNS: usize = 4;
const SIDE: f64 = 440.0;
const LEFT: f64 = 110.0;
const RIGHT: f64 = 24.0;
const GAP: f64 = 28.0;
const TITLE: f64 = 56.0;
const BOTTOM: f64 = 76.0;

/// Draws the groups side by side, to one scale, as a PNG; a trajectory is cut where it leaves
/// the panel. The viewer looks down, so z grows downwards and a turn to the left looks
/// like one.
///
/// # Errors
///
/// If the picture cannot be drawn or written.
pub fn draw(path: &std::path::Path, groups: &[Group]) -> Result<(), ReportError> {
    let columns = groups.len().clamp(1, COLUMNS);
    let rows = groups.len().div_ceil(COLUMNS).max(1);
    let width = LEFT + columns as f64 * (SIDE + GAP) - GAP + RIGHT;
    let height = rows as f64 * (TITLE + SIDE + BOTTOM);
    let square = Square::around(groups);
    let none = [Group {
        title: String::new(),
        paths: Vec::new(),
    }];
    let groups = if groups.is_empty() { &none } else { groups };
    paint(path, width as u32, height as u32, |canvas| {
        for (index, group) in groups.iter().enumerate() {
            let (row, column) = (index / COLUMNS, index % COLUMNS);
            let left = LEFT + column as f64 * (SIDE + GAP);
            let top = row as f64 * (TITLE + SIDE + BOTTOM) + TITLE;
            let plot = square.plot(left, top);
            plot.draw_grid(canvas)?;
            plot.label_x(canvas)?;
            if column == 0 {
                plot.label_y(canvas)?;
            }
            draw_group(canvas, &plot, group)?;
        }
        Ok(())
    })
}

/// The part of the ground that all panels show, in metres.
struct Square {
    centre: (f64, f64),
    half: f64,
}

impl Square {
    /// The smallest square that shows every start and target, with room for labels and turns.
    /// Lost characters leave it: shown whole, the longest would make all others too small to see.
    fn around(groups: &[Group]) -> Self {
        const BESIDE: f64 = 2.5;
        const ABOVE: f64 = 2.5;
        let all = |axis: usize| {
            let paths = groups.iter().flat_map(|group| &group.paths);
            let values =
                paths.flat_map(move |path| path.points.first().into_iter().chain([&path.target]));
            let values = values.filter(|point| ground::finite(point));
            chart::extent(values.map(|point| f64::from(point[axis]))).unwrap_or((0.0, 0.0))
        };
        let (x, z) = (all(0), all(1));
        let half_x = (x.1 - x.0) / 2.0 + ground::TARGET_RADIUS + BESIDE;
        let half_z = (z.1 - z.0) / 2.0 + ground::TARGET_RADIUS + ABOVE;
        Self {
            centre: ((x.0 + x.1) / 2.0, (z.0 + z.1) / 2.0),
            half: half_x.max(half_z),
        }
    }

    fn plot(&self, left: f64, top: f64) -> Plot {
        let frame = PlotArea {
            left,
            top,
            right: left + SIDE,
            bottom: top + SIDE,
        };
        let mut plot = ground::plot(frame, self.centre, self.half);
        for axis in [&mut plot.x, &mut plot.y] {
            // Lines every metre, while these do not crowd.
            if self.half < 15.0 {
                axis.lines = (axis.min.ceil() as i32..=axis.max.floor() as i32)
                    .map(f64::from)
                    .collect();
            }
        }
        plot
    }
}

fn draw_group(canvas: &mut Canvas<'_>, plot: &Plot, group: &Group) -> Result<(), ReportError> {
    let middle = (plot.frame.left + plot.frame.right) / 2.0;
    let at = (middle, plot.frame.top - 24.0);
    canvas.text(&group.title, at, Anchor::Centre, chart::LARGE, chart::INK)?;
    if group.paths.is_empty() {
        return plot.remark(canvas, "no paths");
    }
    // All circles below all lines below all words.
    for path in &group.paths {
        draw_target(canvas, plot, path)?;
    }
    for path in &group.paths {
        draw_path(canvas, plot, path)?;
    }
    for path in &group.paths {
        draw_start(canvas, plot, path)?;
        draw_label(canvas, plot, path)?;
    }
    Ok(())
}

fn draw_target(canvas: &mut Canvas<'_>, plot: &Plot, path: &Path) -> Result<(), ReportError> {
    if !ground::finite(&path.target) {
        return Ok(());
    }
    let centre = ground::place(plot, path.target);
    let colour = chart::colour(path.colour);
    ground::target(canvas, plot, centre, colour, path.reached)
}

fn draw_path(canvas: &mut Canvas<'_>, plot: &Plot, path: &Path) -> Result<(), ReportError> {
    let colour = chart::colour(path.colour);
    let line = walked(plot, path);
    ground::line(canvas, &plot.frame, &line, colour, 3.0)?;
    match line.last() {
        Some(&end) if !ground::inside(&plot.frame, end) => Ok(()),
        Some(&end) if path.reached => canvas.disc(end, 4.5, colour, 1.0),
        Some(&end) => ground::cross(canvas, end, colour),
        None => Ok(()),
    }
}

fn draw_start(canvas: &mut Canvas<'_>, plot: &Plot, path: &Path) -> Result<(), ReportError> {
    match walked(plot, path).first() {
        Some(&start) => ground::start(canvas, start),
        None => Ok(()),
    }
}

/// Writes the label on the far side of the target, where the path does not run.
fn draw_label(canvas: &mut Canvas<'_>, plot: &Plot, path: &Path) -> Result<(), ReportError> {
    let start = path.points.iter().find(|point| ground::finite(point));
    if !ground::finite(&path.target) || path.label.is_empty() {
        return Ok(());
    }
    let target = ground::place(plot, path.target);
    let from = start.map_or(target, |&start| ground::place(plot, start));
    let (x, y) = (target.0 - from.0, target.1 - from.1);
    let length = x.hypot(y);
    let (x, y) = if length > 0.0 {
        (x / length, y / length)
    } else {
        (0.0, -1.0)
    };
    let half = text_width(&path.label, chart::SMALL)? / 2.0;
    let away = ground::target_radius(plot) + 8.0;
    let at = (
        target.0 + x * (away + half),
        target.1 + y * (away + chart::SMALL / 2.0),
    );
    let colour = chart::colour(path.colour);
    canvas.text(&path.label, at, Anchor::Centre, chart::SMALL, colour)
}

fn walked(plot: &Plot, path: &Path) -> Vec<Pixel> {
    let points = path.points.iter().filter(|point| ground::finite(point));
    points.map(|&point| ground::place(plot, point)).collect()
}
