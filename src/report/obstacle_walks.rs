//! Episodes among moving obstacles, seen from above, and the obstacle maps that the policy
//! observed on the way, laid out as the paper's figure 2.

use plotters::style::RGBColor;

use super::ReportError;
use super::canvas::{Anchor, Canvas, Pixel, paint};
use super::chart::{self, Plot, PlotArea};
use super::ground;

mod episode;
mod legend;
mod maps;
mod symbols;

use episode::seconds;
pub use episode::{CELLS, DrawnEpisode, End, Map, Obstacle};
use symbols::{OBSTACLE, SEEN, WAY, draw_arrow, draw_rectangle, turned};

/// Half of what a panel shows, in metres: the square in which obstacles begin, and as
/// much of them as may reach out of it.
const HALF: f64 = 11.5;
/// Half the ground that a map covers, in metres.
const MAP_HALF: f64 = 3.0;

const COLUMNS: usize = 2;
const SIDE: f64 = 560.0;
const LEFT: f64 = 110.0;
const RIGHT: f64 = 24.0;
const GAP: f64 = 64.0;
const TITLE: f64 = 100.0;
const BOTTOM: f64 = 76.0;
/// From a panel to its maps.
const BESIDE: f64 = 28.0;
const EPISODE: f64 = SIDE + BESIDE + maps::SIDE;

/// Draws the episodes, each with its maps beside it, as a PNG. `step_s` is the time from
/// one point to the next and from one map to the other, in seconds.
///
/// Positions are drawn relative to the start, in world axes: the viewer looks
/// down, so z grows downwards and a turn to the left looks like one. The maps are in the
/// character's frame, forward up and its left on the left.
///
/// # Errors
///
/// If the picture cannot be drawn or written.
pub fn draw(
    path: &std::path::Path,
    episodes: &[DrawnEpisode],
    step_s: f32,
) -> Result<(), ReportError> {
    let columns = episodes.len().clamp(1, COLUMNS);
    let rows = episodes.len().div_ceil(COLUMNS).max(1);
    let width = LEFT + columns as f64 * (EPISODE + GAP) - GAP + RIGHT;
    let legend = legend::place(width - LEFT - RIGHT)?;
    let legend_top = rows as f64 * (TITLE + SIDE + BOTTOM);
    let height = legend_top + legend::height(&legend);
    paint(path, width as u32, height as u32, |canvas| {
        for (index, episode) in episodes.iter().enumerate() {
            let (row, column) = (index / COLUMNS, index % COLUMNS);
            let left = LEFT + column as f64 * (EPISODE + GAP);
            let top = row as f64 * (TITLE + SIDE + BOTTOM) + TITLE;
            draw_episode(canvas, episode, step_s, (left, top))?;
        }
        if episodes.is_empty() {
            plot(LEFT, TITLE).remark(canvas, "no episodes")?;
        }
        legend::draw(canvas, &legend, (LEFT, legend_top))
    })
}

fn plot(left: f64, top: f64) -> Plot {
    let frame = PlotArea {
        left,
        top,
        right: left + SIDE,
        bottom: top + SIDE,
    };
    ground::plot(frame, (0.0, 0.0), HALF)
}

fn draw_episode(
    canvas: &mut Canvas<'_>,
    episode: &DrawnEpisode,
    step_s: f32,
    (left, top): Pixel,
) -> Result<(), ReportError> {
    let plot = plot(left, top);
    plot.draw_grid(canvas)?;
    let scene = Scene {
        plot: &plot,
        origin: episode.points.first().copied().unwrap_or_default(),
        colour: colour(episode.end),
    };
    scene.draw_obstacles(canvas, episode)?;
    scene.draw_target(canvas, episode)?;
    scene.draw_covered(canvas, episode)?;
    scene.draw_walk(canvas, episode, step_s)?;
    plot.label_x(canvas)?;
    if left <= LEFT {
        plot.label_y(canvas)?;
    }
    draw_heading(canvas, &plot, episode, step_s)?;
    maps::draw(canvas, episode, step_s, (left + SIDE + BESIDE, top + SIDE))
}

fn colour(end: End) -> RGBColor {
    chart::colour(match end {
        End::Reached => 2,
        End::Collided => 1,
        End::UnderWay => 0,
    })
}

/// A panel, and what all of its episode shares.
struct Scene<'a> {
    plot: &'a Plot,
    /// The world x and z that the panel is centred on.
    origin: [f32; 2],
    colour: RGBColor,
}

impl Scene<'_> {
    fn place(&self, [x, z]: [f32; 2]) -> Pixel {
        ground::place(self.plot, [x - self.origin[0], z - self.origin[1]])
    }

    fn inside(&self, at: Pixel) -> bool {
        ground::inside(&self.plot.frame, at)
    }

    fn line(
        &self,
        canvas: &mut Canvas<'_>,
        line: &[Pixel],
        colour: RGBColor,
        width: f64,
    ) -> Result<(), ReportError> {
        ground::line(canvas, &self.plot.frame, line, colour, width)
    }

    /// All boxes below all their ways.
    fn draw_obstacles(
        &self,
        canvas: &mut Canvas<'_>,
        episode: &DrawnEpisode,
    ) -> Result<(), ReportError> {
        for obstacle in &episode.obstacles {
            self.draw_box(canvas, obstacle, OBSTACLE)?;
        }
        if let Some(hit) = hit(episode) {
            self.draw_box(canvas, hit, self.colour)?;
        }
        for obstacle in &episode.obstacles {
            let (start, end) = (self.place(obstacle.start), self.place(obstacle.end));
            self.line(canvas, &[start, end], WAY, 1.2)?;
            if self.inside(end) {
                canvas.disc(end, 2.4, WAY, 1.0)?;
            }
        }
        Ok(())
    }

    /// As it stood at the end, cut at the panel's edges.
    fn draw_box(
        &self,
        canvas: &mut Canvas<'_>,
        obstacle: &Obstacle,
        colour: RGBColor,
    ) -> Result<(), ReportError> {
        let [[x, z], [half_x, half_z]] = [obstacle.end, obstacle.half.map(f32::abs)];
        let PlotArea {
            left,
            top,
            right,
            bottom,
        } = self.plot.frame;
        let cut = |(x, y): Pixel| (x.clamp(left, right), y.clamp(top, bottom));
        let corner = cut(self.place([x - half_x, z - half_z]));
        let opposite = cut(self.place([x + half_x, z + half_z]));
        if corner.0 < opposite.0 && corner.1 < opposite.1 {
            draw_rectangle(canvas, corner, opposite, colour)?;
        }
        Ok(())
    }

    fn draw_target(
        &self,
        canvas: &mut Canvas<'_>,
        episode: &DrawnEpisode,
    ) -> Result<(), ReportError> {
        let centre = self.place(episode.target);
        if !self.inside(centre) {
            return Ok(());
        }
        let reached = episode.end == End::Reached;
        ground::target(canvas, self.plot, centre, self.colour, reached)
    }

    /// The outline of the ground that the maps cover.
    fn draw_covered(
        &self,
        canvas: &mut Canvas<'_>,
        episode: &DrawnEpisode,
    ) -> Result<(), ReportError> {
        let Some(&seen) = episode.points.get(episode.seen) else {
            return Ok(());
        };
        let forward = direction(episode.heading);
        let centre = self.place(seen);
        let reach = ground::pixels(self.plot, MAP_HALF);
        let corner = |ahead, right| turned(centre, forward, reach * ahead, reach * right);
        let outline = [(1, -1), (1, 1), (-1, 1), (-1, -1), (1, -1)]
            .map(|(ahead, right): (i8, i8)| corner(f64::from(ahead), f64::from(right)));
        self.line(canvas, &outline, SEEN, 1.6)
    }

    fn draw_walk(
        &self,
        canvas: &mut Canvas<'_>,
        episode: &DrawnEpisode,
        step_s: f32,
    ) -> Result<(), ReportError> {
        let line: Vec<Pixel> = episode.points.iter().map(|&at| self.place(at)).collect();
        self.line(canvas, &line, self.colour, 3.0)?;
        let visible = |at: &&Pixel| self.inside(**at);
        let second = (1.0 / step_s).round().max(1.0) as usize;
        for &at in line.iter().step_by(second).skip(1).filter(visible) {
            canvas.disc(at, 5.0, self.colour, 1.0)?;
        }
        if let Some(&start) = line.first().filter(visible) {
            ground::start(canvas, start)?;
        }
        if let Some(&end) = line.last().filter(visible) {
            draw_end(canvas, end, episode.end)?;
        }
        if let Some(&seen) = line.get(episode.seen).filter(visible) {
            draw_arrow(canvas, seen, direction(episode.heading))?;
        }
        Ok(())
    }
}

/// The obstacle that ended the episode: the one nearest to its end.
fn hit(episode: &DrawnEpisode) -> Option<&Obstacle> {
    let end = episode.points.last()?;
    let gap = |obstacle: &&Obstacle| {
        let apart =
            |axis: usize| (end[axis] - obstacle.end[axis]).abs() - obstacle.half[axis].abs();
        apart(0).max(0.0).hypot(apart(1).max(0.0))
    };
    episode
        .obstacles
        .iter()
        .filter(|_| episode.end == End::Collided)
        .min_by(|one, other| gap(one).total_cmp(&gap(other)))
}

/// A heading's direction in the picture, of length 1; up where there is none.
fn direction([x, z]: [f32; 2]) -> Pixel {
    let (x, z) = (f64::from(x), f64::from(z));
    let length = x.hypot(z);
    if length > 0.0 && length.is_finite() {
        (x / length, z / length)
    } else {
        (0.0, -1.0)
    }
}

fn draw_end(canvas: &mut Canvas<'_>, at: Pixel, end: End) -> Result<(), ReportError> {
    match end {
        End::Reached => canvas.disc(at, 8.0, colour(end), 1.0),
        End::Collided => ground::cross(canvas, at, colour(end)),
        End::UnderWay => ground::ring(canvas, at, colour(end)),
    }
}

/// The title, and how the episode ended.
fn draw_heading(
    canvas: &mut Canvas<'_>,
    plot: &Plot,
    episode: &DrawnEpisode,
    step_s: f32,
) -> Result<(), ReportError> {
    let PlotArea { left, top, .. } = plot.frame;
    let at = (left, top - 66.0);
    canvas.text(&episode.title, at, Anchor::Left, chart::LARGE, chart::INK)?;
    let words = match episode.end {
        End::Reached => "reached",
        End::Collided => "collided",
        End::UnderWay => "still under way",
    };
    let last = episode.points.len().saturating_sub(1);
    let text = format!("{words} after {}", seconds(last, step_s));
    draw_end(canvas, (left + 10.0, top - 28.0), episode.end)?;
    let (at, colour) = ((left + 30.0, top - 28.0), colour(episode.end));
    canvas.text(&text, at, Anchor::Left, chart::NORMAL, colour)
}
