//! What pictures of the ground have in common. The viewer looks down: x grows to the
//! right and z downwards, so a turn to the left looks like one.

use plotters::style::RGBColor;

use super::ReportError;
use super::canvas::{Canvas, Pixel};
use super::chart::{self, Axis, Plot, PlotArea};

/// Distance from the target at which it counts as reached, in metres.
pub const TARGET_RADIUS: f64 = 0.5;

/// The square of ground within `half` metres of `centre`, which is (x, z).
pub fn plot(frame: PlotArea, centre: (f64, f64), half: f64) -> Plot {
    let axis = |label, centre| Axis::new(label, (centre - half, centre + half), 7);
    // A plot grows upwards, but z grows downwards: the plot's y is -z.
    let mut z = axis("z (m)", -centre.1);
    z.format = |value| chart::number(-value);
    Plot {
        frame,
        x: axis("x (m)", centre.0),
        y: z,
    }
}

/// The pixel of x and z, in metres.
pub fn place(plot: &Plot, [x, z]: [f32; 2]) -> Pixel {
    plot.at(f64::from(x), -f64::from(z))
}

/// A length on the ground in pixels.
pub fn pixels(plot: &Plot, metres: f64) -> f64 {
    metres * (plot.frame.right - plot.frame.left) / (plot.x.max - plot.x.min)
}

/// The target's circle in pixels.
pub fn target_radius(plot: &Plot) -> f64 {
    pixels(plot, TARGET_RADIUS)
}

/// Whether both coordinates are finite.
pub fn finite(point: &[f32; 2]) -> bool {
    point.iter().all(|value| value.is_finite())
}

/// Whether a pixel is within the frame.
pub fn inside(frame: &PlotArea, (x, y): Pixel) -> bool {
    (frame.left..=frame.right).contains(&x) && (frame.top..=frame.bottom).contains(&y)
}

/// A line through `points`, cut where it leaves the frame and broken where a point is not
/// finite.
pub fn line(
    canvas: &mut Canvas<'_>,
    frame: &PlotArea,
    points: &[Pixel],
    colour: RGBColor,
    width: f64,
) -> Result<(), ReportError> {
    let mut piece: Vec<Pixel> = Vec::new();
    for ends in points.windows(2) {
        let Some([from, to]) = cut(frame, ends[0], ends[1]) else {
            continue;
        };
        if piece.last() != Some(&from) {
            canvas.line(&piece, colour, width)?;
            piece = vec![from];
        }
        piece.push(to);
    }
    canvas.line(&piece, colour, width)
}

/// The part of a straight line within the frame.
fn cut(frame: &PlotArea, from: Pixel, to: Pixel) -> Option<[Pixel; 2]> {
    let (x, y) = (to.0 - from.0, to.1 - from.1);
    let (mut enters, mut leaves) = (0.0_f64, 1.0_f64);
    for (start, length, min, max) in [
        (from.0, x, frame.left, frame.right),
        (from.1, y, frame.top, frame.bottom),
    ] {
        // A line along the edges crosses them infinitely far away.
        let (one, other) = ((min - start) / length, (max - start) / length);
        enters = enters.max(one.min(other));
        leaves = leaves.min(one.max(other));
    }
    // This way the ends are exact, so that pieces meet.
    let between = |from: f64, to: f64, part: f64| (1.0 - part) * from + part * to;
    let at = |part: f64| (between(from.0, to.0, part), between(from.1, to.1, part));
    let finite = x.is_finite() && y.is_finite();
    (finite && enters < leaves).then(|| [at(enters), at(leaves)])
}

/// The target's circle, shaded; its edge is dashed unless the target was reached.
pub fn target(
    canvas: &mut Canvas<'_>,
    plot: &Plot,
    centre: Pixel,
    colour: RGBColor,
    reached: bool,
) -> Result<(), ReportError> {
    let radius = target_radius(plot);
    canvas.disc(centre, radius, colour, 0.14)?;
    circle(canvas, centre, radius, colour, reached)
}

/// A circle's edge, dashed unless `whole`.
pub fn circle(
    canvas: &mut Canvas<'_>,
    centre: Pixel,
    radius: f64,
    colour: RGBColor,
    whole: bool,
) -> Result<(), ReportError> {
    const CORNERS: u32 = 48;
    let corner = |index: u32| {
        let angle = f64::from(index) * std::f64::consts::TAU / f64::from(CORNERS);
        (
            centre.0 + radius * angle.cos(),
            centre.1 + radius * angle.sin(),
        )
    };
    for index in (0..CORNERS).filter(|index| whole || index % 4 < 2) {
        canvas.line(&[corner(index), corner(index + 1)], colour, 2.0)?;
    }
    Ok(())
}

/// The start of an episode.
pub fn start(canvas: &mut Canvas<'_>, at: Pixel) -> Result<(), ReportError> {
    ring(canvas, at, chart::INK)
}

/// A small ring with a white middle.
pub fn ring(canvas: &mut Canvas<'_>, at: Pixel, colour: RGBColor) -> Result<(), ReportError> {
    canvas.disc(at, 8.0, colour, 1.0)?;
    canvas.disc(at, 4.5, chart::tint(colour, 0.0), 1.0)
}

/// A small cross.
pub fn cross(canvas: &mut Canvas<'_>, (x, y): Pixel, colour: RGBColor) -> Result<(), ReportError> {
    const ARM: f64 = 6.5;
    canvas.line(&[(x - ARM, y - ARM), (x + ARM, y + ARM)], colour, 3.0)?;
    canvas.line(&[(x - ARM, y + ARM), (x + ARM, y - ARM)], colour, 3.0)
}
