//! The shared look of all charts: colours, sizes, axes.

use plotters::style::RGBColor;

use super::ReportError;
use super::canvas::{Anchor, Canvas, Pixel};

/// Titles and axis labels.
pub const INK: RGBColor = RGBColor(0x1f, 0x25, 0x2e);
/// Numbers along the axes, and remarks.
pub const MUTED: RGBColor = RGBColor(0x4b, 0x55, 0x63);
/// The grid.
pub const GRID: RGBColor = RGBColor(0xe4, 0xe7, 0xeb);
/// The axes themselves.
pub const FRAME: RGBColor = RGBColor(0x9a, 0xa3, 0xaf);

/// Okabe and Ito's colours, which stay apart for colour-blind eyes; the first four are
/// the paper's blue, red, green and purple.
pub const PALETTE: [RGBColor; 7] = [
    RGBColor(0x00, 0x72, 0xb2),
    RGBColor(0xd5, 0x5e, 0x00),
    RGBColor(0x00, 0x9e, 0x73),
    RGBColor(0xa6, 0x4d, 0x8a),
    RGBColor(0xe6, 0x9f, 0x00),
    RGBColor(0x3a, 0xa0, 0xdb),
    RGBColor(0x55, 0x5b, 0x66),
];

/// Height of the numbers along an axis, in pixels.
pub const SMALL: f64 = 22.0;
/// Height of an axis label, in pixels.
pub const NORMAL: f64 = 24.0;
/// Height of a panel's title, in pixels.
pub const LARGE: f64 = 28.0;

/// The palette's colour of that index; after the last come darker shades, then lighter ones, then all again.
pub fn colour(index: usize) -> RGBColor {
    let colour = PALETTE[index % PALETTE.len()];
    match index / PALETTE.len() % 3 {
        0 => colour,
        1 => shade(colour, 0.5),
        _ => tint(colour, 0.5),
    }
}

/// `strength` 1 is the colour itself, 0 black.
fn shade(colour: RGBColor, strength: f64) -> RGBColor {
    let mix = |part: u8| (strength * f64::from(part)).round() as u8;
    RGBColor(mix(colour.0), mix(colour.1), mix(colour.2))
}

/// `strength` 1 is the colour itself, 0 white.
pub fn tint(colour: RGBColor, strength: f64) -> RGBColor {
    let mix =
        |part: u8| (255.0 - strength.clamp(0.0, 1.0) * (255.0 - f64::from(part))).round() as u8;
    RGBColor(mix(colour.0), mix(colour.1), mix(colour.2))
}

/// One direction of a plot.
pub struct Axis {
    /// The value at the left or lower end.
    pub min: f64,
    /// The value at the right or upper end.
    pub max: f64,
    /// Values that get a grid line and a number.
    pub ticks: Vec<f64>,
    /// Values that get a grid line only.
    pub lines: Vec<f64>,
    /// What is measured, with its unit.
    pub label: &'static str,
    /// How a tick's value reads.
    pub format: fn(f64) -> String,
}

impl Axis {
    /// An axis from `min` to `max` with at most `count` round numbers along it.
    pub fn new(label: &'static str, (min, max): (f64, f64), count: usize) -> Self {
        Self {
            min,
            max,
            ticks: ticks(min, max, count),
            lines: Vec::new(),
            label,
            format: number,
        }
    }

    fn part(&self, value: f64) -> f64 {
        (value - self.min) / (self.max - self.min)
    }
}

/// A rectangle of the picture, in pixels.
#[derive(Clone, Copy)]
pub struct PlotArea {
    /// Left edge, pixels.
    pub left: f64,
    /// Upper edge, pixels.
    pub top: f64,
    /// Right edge, pixels.
    pub right: f64,
    /// Lower edge, pixels.
    pub bottom: f64,
}

/// A rectangle with two axes.
pub struct Plot {
    /// The area within the axes.
    pub frame: PlotArea,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
}

impl Plot {
    /// The pixel of a pair of values.
    pub fn at(&self, x: f64, y: f64) -> Pixel {
        let PlotArea {
            left,
            top,
            right,
            bottom,
        } = self.frame;
        (
            left + self.x.part(x) * (right - left),
            bottom - self.y.part(y) * (bottom - top),
        )
    }

    /// Whether a pair of values is within the axes.
    pub fn holds(&self, x: f64, y: f64) -> bool {
        (self.x.min..=self.x.max).contains(&x) && (self.y.min..=self.y.max).contains(&y)
    }

    /// The grid and the two axis lines: to be drawn before the data.
    pub fn draw_grid(&self, canvas: &mut Canvas<'_>) -> Result<(), ReportError> {
        let PlotArea {
            left,
            top,
            right,
            bottom,
        } = self.frame;
        for &x in self.x.ticks.iter().chain(&self.x.lines) {
            let (x, _) = self.at(x, self.y.min);
            canvas.line(&[(x, top), (x, bottom)], GRID, 1.0)?;
        }
        for &y in self.y.ticks.iter().chain(&self.y.lines) {
            let (_, y) = self.at(self.x.min, y);
            canvas.line(&[(left, y), (right, y)], GRID, 1.0)?;
        }
        canvas.line(&[(left, top), (left, bottom), (right, bottom)], FRAME, 1.2)
    }

    /// The numbers and the label below the plot.
    pub fn label_x(&self, canvas: &mut Canvas<'_>) -> Result<(), ReportError> {
        let PlotArea {
            left,
            right,
            bottom,
            ..
        } = self.frame;
        for &tick in &self.x.ticks {
            let (x, _) = self.at(tick, self.y.min);
            let text = (self.x.format)(tick);
            canvas.text(&text, (x, bottom + 22.0), Anchor::Centre, SMALL, MUTED)?;
        }
        let middle = f64::midpoint(left, right);
        let at = (middle, bottom + 54.0);
        canvas.text(self.x.label, at, Anchor::Centre, NORMAL, INK)
    }

    /// The numbers and the label to the left of the plot.
    pub fn label_y(&self, canvas: &mut Canvas<'_>) -> Result<(), ReportError> {
        let PlotArea {
            left, top, bottom, ..
        } = self.frame;
        for &tick in &self.y.ticks {
            let (_, y) = self.at(self.x.min, tick);
            let text = (self.y.format)(tick);
            canvas.text(&text, (left - 12.0, y), Anchor::Right, SMALL, MUTED)?;
        }
        let middle = f64::midpoint(top, bottom);
        canvas.text_upwards(self.y.label, (left - 88.0, middle), NORMAL, INK)
    }

    /// A remark in the middle, for a plot that has nothing to show.
    pub fn remark(&self, canvas: &mut Canvas<'_>, text: &str) -> Result<(), ReportError> {
        let middle = (
            (self.frame.left + self.frame.right) / 2.0,
            (self.frame.top + self.frame.bottom) / 2.0,
        );
        canvas.text(text, middle, Anchor::Centre, NORMAL, MUTED)
    }
}

/// Sets items of these widths, in pixels, in rows no wider than `room`: for each its left
/// end and its row.
pub fn flow(widths: &[f64], gap: f64, room: f64) -> Vec<(f64, usize)> {
    let (mut left, mut row) = (0.0, 0);
    let mut places = Vec::with_capacity(widths.len());
    for width in widths {
        if left > 0.0 && left + width > room {
            (left, row) = (0.0, row + 1);
        }
        places.push((left, row));
        left += width + gap;
    }
    places
}

/// At most `count` multiples of 1, 2 or 5 times a power of ten between `min` and `max`.
pub fn ticks(min: f64, max: f64, count: usize) -> Vec<f64> {
    let rough = (max - min) / count.max(1) as f64;
    if !rough.is_finite() || rough <= 0.0 {
        return Vec::new();
    }
    let power = 10_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .map(|factor| factor * power)
        .into_iter()
        .find(|&step| step >= rough * (1.0 - 1e-9))
        .unwrap_or(10.0 * power);
    let first = (min / step - 1e-9).ceil();
    (0..=count)
        .map(|index| (first + index as f64) * step)
        .take_while(|&tick| tick <= max + 1e-9 * step)
        .collect()
}

/// The smallest and the largest finite value, or `None` if there is none.
pub fn extent(values: impl IntoIterator<Item = f64>) -> Option<(f64, f64)> {
    values
        .into_iter()
        .filter(|value| value.is_finite())
        .fold(None, |extent, value| {
            let (min, max) = extent.unwrap_or((value, value));
            Some((value.min(min), value.max(max)))
        })
}

/// A number without trailing zeros and with a true minus sign.
pub fn number(value: f64) -> String {
    if value.abs() >= 1e9 {
        return format!("{value:.1e}");
    }
    let rounded = (value * 1e6).round() / 1e6;
    if rounded < 0.0 {
        format!("\u{2212}{}", -rounded)
    } else {
        format!("{}", rounded.abs())
    }
}

/// A number of steps in few letters: 500, 20k, 1.5M.
pub fn steps(value: f64) -> String {
    let brief = |value: f64| number((value * 100.0).round() / 100.0);
    match value.abs() {
        1e6.. => format!("{}M", brief(value / 1e6)),
        1e3.. => format!("{}k", brief(value / 1e3)),
        _ => brief(value),
    }
}
