//! Coverage of a database: how fast they go, how sharply they turn and
//! in which directions they move.

use std::path::Path;

use plotters::style::RGBColor;

use super::ReportError;
use super::canvas::{Anchor, Canvas, paint};
use super::chart::{self, Axis, Plot, PlotArea};

/// One value for each frame. Frames with a value that is not finite are left out.
#[derive(Clone, Copy, Debug)]
pub struct CoverageSamples<'a> {
    /// Frames in a second.
    pub rate_hz: f32,
    /// Speed of the root along the ground, in m/s.
    pub speed: &'a [f32],
    /// Turning rate of the root, in degrees a second.
    pub turning: &'a [f32],
    /// Ground velocity of the root in the character frame, in m/s: sideways, forward.
    pub velocity: &'a [[f32; 2]],
}

const SIDE: f64 = 600.0;
const LEFT: f64 = 120.0;
const TOP: f64 = 40.0;
const GAP: f64 = 150.0;
const BOTTOM: f64 = 84.0;
/// Room to the right of the plots for the colour scale.
const RIGHT: f64 = 190.0;
const WIDTH: f64 = LEFT + 2.0 * SIDE + GAP + RIGHT;
const HEIGHT: f64 = TOP + SIDE + BOTTOM;

/// Cells along each side of a plot.
const CELLS: usize = 100;

/// The colour map "mako", light to dark: its lightness falls evenly, so that equal
/// ratios of minutes look like equal steps, in print and to colour-blind eyes too.
const COLOURS: [RGBColor; 9] = [
    RGBColor(0xde, 0xf5, 0xe5),
    RGBColor(0xad, 0xe3, 0xc0),
    RGBColor(0x6c, 0xd3, 0xad),
    RGBColor(0x43, 0xbb, 0xad),
    RGBColor(0x35, 0xa1, 0xab),
    RGBColor(0x34, 0x87, 0xa6),
    RGBColor(0x38, 0x6c, 0x9c),
    RGBColor(0x41, 0x4f, 0x8a),
    RGBColor(0x3b, 0x30, 0x57),
];

/// Draws how the minutes are spread over speed and turning rate, and over local
/// velocity, as a PNG. The outermost thousandth of the frames may be outside the plots.
///
/// # Errors
///
/// If the picture cannot be drawn or written.
pub fn draw(path: &Path, samples: &CoverageSamples<'_>) -> Result<(), ReportError> {
    let minutes = 1.0 / (60.0 * f64::from(samples.rate_hz));
    let turns: Vec<(f64, f64)> = pairs(samples.speed.iter().zip(samples.turning));
    let moves: Vec<(f64, f64)> = pairs(samples.velocity.iter().map(|[side, ahead]| (side, ahead)));
    let panels = [turning_plot(&turns), velocity_plot(&moves)];
    let densities = [
        Density::of(&turns, &panels[0], minutes),
        Density::of(&moves, &panels[1], minutes),
    ];
    let scale = Scale::of(&densities, minutes);
    paint(path, WIDTH as u32, HEIGHT as u32, |canvas| {
        for (plot, density) in panels.iter().zip(&densities) {
            plot.draw_grid(canvas)?;
            draw_density(canvas, plot, density, scale.as_ref())?;
            plot.label_x(canvas)?;
            plot.label_y(canvas)?;
        }
        scale.map_or(Ok(()), |scale| scale.draw(canvas))
    })
}

fn pairs<'a>(values: impl Iterator<Item = (&'a f32, &'a f32)>) -> Vec<(f64, f64)> {
    values
        .map(|(&x, &y)| (f64::from(x), f64::from(y)))
        .filter(|(x, y)| x.is_finite() && y.is_finite())
        .collect()
}

fn turning_plot(turns: &[(f64, f64)]) -> Plot {
    let speed = reach(turns.iter().map(|turn| turn.0), 1.0);
    let turning = reach(turns.iter().map(|turn| turn.1), 90.0);
    let mut y = Axis::new("turning rate (deg/s)", (-turning, turning), 9);
    // Numbers that people think in: eighths of a turn.
    if turning < 270.0 {
        y.ticks = (-5..=5)
            .map(|eighth| 45.0 * f64::from(eighth))
            .filter(|tick| tick.abs() <= turning)
            .collect();
    }
    Plot {
        frame: frame(0),
        x: Axis::new("speed (m/s)", (0.0, speed), 8),
        y,
    }
}

/// Both axes to one scale, for the plot is a map of the directions.
fn velocity_plot(moves: &[(f64, f64)]) -> Plot {
    let side = reach(moves.iter().map(|&(side, _)| side), 0.5);
    let ahead = reach(moves.iter().map(|&(_, ahead)| ahead.max(0.0)), 0.5);
    let back = reach(moves.iter().map(|&(_, ahead)| ahead.min(0.0)), 0.5);
    let half = side.max((ahead + back) / 2.0);
    let middle = (ahead - back) / 2.0;
    let forward = (middle - half, middle + half);
    Plot {
        frame: frame(1),
        x: Axis::new("sideways velocity (m/s)", (-half, half), 10),
        y: Axis::new("forward velocity (m/s)", forward, 10),
    }
}

fn frame(column: usize) -> PlotArea {
    let left = LEFT + column as f64 * (SIDE + GAP);
    PlotArea {
        left,
        top: TOP,
        right: left + SIDE,
        bottom: TOP + SIDE,
    }
}

/// The magnitude that only one value in a thousand exceeds, and some room; at least
/// `least`.
fn reach(values: impl Iterator<Item = f64>, least: f64) -> f64 {
    let mut sizes: Vec<f64> = values.map(f64::abs).collect();
    sizes.sort_by(f64::total_cmp);
    let rank = sizes.len() * 999 / 1000;
    sizes
        .get(rank)
        .map_or(least, |&size| (1.05 * size).max(least))
}

/// Minutes in each cell of a plot; cell (column, row) is at `row * CELLS + column`.
struct Density {
    minutes: Vec<f64>,
}

impl Density {
    fn of(values: &[(f64, f64)], plot: &Plot, minutes: f64) -> Self {
        let cell = |value: f64, axis: &Axis| {
            let part = (value - axis.min) / (axis.max - axis.min);
            ((part * CELLS as f64) as usize).min(CELLS - 1)
        };
        let mut density = vec![0.0; CELLS * CELLS];
        for &(x, y) in values.iter().filter(|&&(x, y)| plot.holds(x, y)) {
            density[cell(y, &plot.y) * CELLS + cell(x, &plot.x)] += minutes;
        }
        Self { minutes: density }
    }

    fn max(&self) -> f64 {
        self.minutes.iter().copied().fold(0.0, f64::max)
    }
}

fn draw_density(
    canvas: &mut Canvas<'_>,
    plot: &Plot,
    density: &Density,
    scale: Option<&Scale>,
) -> Result<(), ReportError> {
    let Some(scale) = scale.filter(|_| density.max() > 0.0) else {
        return plot.remark(canvas, "no frames");
    };
    let PlotArea { left, bottom, .. } = plot.frame;
    let size = SIDE / CELLS as f64;
    for (index, &minutes) in density.minutes.iter().enumerate() {
        if minutes > 0.0 {
            let x = left + (index % CELLS) as f64 * size;
            let y = bottom - (index / CELLS) as f64 * size;
            canvas.rectangle((x, y), (x + size, y - size), scale.colour(minutes))?;
        }
    }
    Ok(())
}

/// Colours for minutes: equal ratios are equal steps.
struct Scale {
    min: f64,
    max: f64,
}

impl Scale {
    /// From one frame to the fullest cell; `None` if all cells are empty.
    fn of(densities: &[Density], frame: f64) -> Option<Self> {
        let max = densities.iter().map(Density::max).fold(0.0, f64::max);
        (max > 0.0 && max.is_finite()).then_some(Self {
            min: frame,
            max: max.max(10.0 * frame),
        })
    }

    fn part(&self, minutes: f64) -> f64 {
        (minutes / self.min).ln() / (self.max / self.min).ln()
    }

    fn colour(&self, minutes: f64) -> RGBColor {
        shade(self.part(minutes))
    }

    fn draw(&self, canvas: &mut Canvas<'_>) -> Result<(), ReportError> {
        let left = WIDTH - RIGHT + 40.0;
        let right = left + 26.0;
        let (top, bottom) = (TOP, TOP + SIDE);
        let slices = SIDE as usize;
        for slice in 0..slices {
            let y = bottom - slice as f64;
            let colour = shade((slice as f64 + 0.5) / slices as f64);
            canvas.rectangle((left, y), (right, y - 1.0), colour)?;
        }
        let first = self.min.log10().ceil() as i32;
        let last = self.max.log10().floor() as i32;
        for power in first..=last {
            let minutes = 10_f64.powi(power);
            let y = bottom - self.part(minutes) * (bottom - top);
            canvas.line(&[(right, y), (right + 7.0, y)], chart::FRAME, 1.2)?;
            let (text, at) = (chart::number(minutes), (right + 14.0, y));
            canvas.text(&text, at, Anchor::Left, chart::SMALL, chart::MUTED)?;
        }
        let at = (right + 100.0, (top + bottom) / 2.0);
        canvas.text_upwards("minutes per cell", at, chart::NORMAL, chart::INK)
    }
}

/// The colour map at `part`, 0 to 1.
fn shade(part: f64) -> RGBColor {
    let place = part.clamp(0.0, 1.0) * (COLOURS.len() - 1) as f64;
    let below = (place as usize).min(COLOURS.len() - 2);
    let (from, to) = (COLOURS[below], COLOURS[below + 1]);
    let weight = place - below as f64;
    let mix =
        |from: u8, to: u8| (f64::from(from) * (1.0 - weight) + f64::from(to) * weight).round();
    RGBColor(
        mix(from.0, to.0) as u8,
        mix(from.1, to.1) as u8,
        mix(from.2, to.2) as u8,
    )
}
