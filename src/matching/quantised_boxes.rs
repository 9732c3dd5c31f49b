//! Boxes in whole numbers of sixteen bits: half the memory of others, and twice as many at a time.
//!
//! Boxes are widened to the grid, and points outside it are moved to its edge: both make distances
//! only less. What moving leaves out is known ([`OutOfGrid`]).

use crate::motion::features::{POSE_DIM, TRAJECTORY_DIM};

/// Boxes side by side: the width of the widest vector registers.
pub const LANES: usize = 16;

/// A grid of `2^16` points a side in `D` dimensions, which are stored as `P` pairs.
pub struct QuantisationGrid<const D: usize, const P: usize> {
    /// Corner of the zeros.
    origin: [f32; D],
    /// Grid steps a unit.
    resolution: f32,
}

/// Pairs of dimensions of the trajectory and of the pose.
pub const TRAJECTORY_PAIRS: usize = TRAJECTORY_DIM.div_ceil(2);
pub const POSE_PAIRS: usize = POSE_DIM.div_ceil(2);

/// A point on a grid; an odd number of dimensions is followed by a 0.
pub type GridPoint<const P: usize> = [[u16; 2]; P];
/// Corners of sixteen boxes, in pairs of dimensions, so that the matching two coordinates of a point are
/// one number of 32 bits, which processors broadcast to all lanes while they load it.
pub type QuantisedCorners<const P: usize> = [[u16; 2 * LANES]; P];

/// Distance of a point outside the grid to its edge, which its grid point leaves out.
pub struct OutOfGrid<const P: usize> {
    /// Twice the distance along each dimension, in grid steps.
    twice: GridPoint<P>,
    /// Squared distance.
    pub squared: f32,
}

impl<const P: usize> OutOfGrid<P> {
    pub const NONE: Self = OutOfGrid {
        twice: [[0; 2]; P],
        squared: 0.0,
    };
}

/// Sixteen boxes on a grid.
#[repr(align(64))]
pub struct QuantisedBoxes<const P: usize> {
    pub low: QuantisedCorners<P>,
    pub high: QuantisedCorners<P>,
}

/// Width of the grid relative to that of the data: queries may lie beside these.
const MARGIN: f32 = 1.5;

impl<const D: usize, const P: usize> QuantisationGrid<D, P> {
    /// The grid around the box from `low` to `high`.
    pub fn enclosing(low: &[f32; D], high: &[f32; D]) -> Self {
        let widths = low.iter().zip(high).map(|(low, high)| high - low);
        // Of a point any width would do but 0.
        let width = MARGIN * widths.fold(1e-15, f32::max);
        QuantisationGrid {
            origin: std::array::from_fn(|d| 0.5 * (low[d] + high[d]) - 0.5 * width),
            resolution: f32::from(u16::MAX) / width,
        }
    }

    /// The nearest grid point: off by half a step, and by what rounding adds to that, a hundredth.
    #[inline(always)]
    pub fn quantise(&self, values: &[f32]) -> GridPoint<P> {
        let mut point = [[0; 2]; P];
        let all = point.as_flattened_mut().iter_mut();
        for ((point, value), origin) in all.zip(values).zip(self.origin) {
            *point = ((value - origin) * self.resolution + 0.5) as u16;
        }
        point
    }

    /// Distance of a point to the grid.
    #[inline(always)]
    pub fn out_of_grid(&self, values: &[f32]) -> OutOfGrid<P> {
        let mut out_of_grid = OutOfGrid::NONE;
        let width = f32::from(u16::MAX) / self.resolution;
        let all = out_of_grid.twice.as_flattened_mut().iter_mut();
        for ((twice, value), origin) in all.zip(values).zip(self.origin) {
            let away = (origin - value).max(value - origin - width).max(0.0);
            *twice = (2.0 * away * self.resolution) as u16;
            out_of_grid.squared += away * away;
        }
        out_of_grid
    }

    /// Boxes widened by a step on each side: more than a quantised point can be off. Lanes without a box
    /// hold infinity; they have no rows, and their distance does not matter.
    pub fn quantise_boxes(
        &self,
        low: &[[f32; LANES]; D],
        high: &[[f32; LANES]; D],
    ) -> QuantisedBoxes<P> {
        QuantisedBoxes {
            low: self.corners(low, -1.0),
            high: self.corners(high, 2.0),
        }
    }

    fn corners(&self, values: &[[f32; LANES]; D], offset: f32) -> QuantisedCorners<P> {
        // All points have a 0 behind the last dimension, and so is their distance to these corners.
        let mut corners = [[0; 2 * LANES]; P];
        for (d, values) in values.iter().enumerate() {
            for (lane, value) in values.iter().enumerate() {
                let step = (value - self.origin[d]) * self.resolution + offset;
                corners[d / 2][2 * lane + d % 2] = step as u16;
            }
        }
        corners
    }

    /// Position of a corner of a box.
    pub fn corner(&self, corners: &QuantisedCorners<P>, lane: usize) -> [f32; D] {
        std::array::from_fn(|d| {
            self.origin[d] + f32::from(corners[d / 2][2 * lane + d % 2]) / self.resolution
        })
    }

    /// Lower bounds of the squared distances from a point to boxes.
    #[inline(always)]
    pub fn squared_distances(
        &self,
        boxes: &QuantisedBoxes<P>,
        point: &GridPoint<P>,
        out_of_grid: &OutOfGrid<P>,
    ) -> [f32; LANES] {
        let unit = 65536.0 / (self.resolution * self.resolution);
        let inside = boxes.squared_distances(point, &out_of_grid.twice);
        inside.map(|squared| squared as f32 * unit + out_of_grid.squared)
    }
}

impl<const P: usize> QuantisedBoxes<P> {
    /// Lower bounds of the squared distances in units of 65536 square steps: a dimension's rest below
    /// that is left out, and what is more than fits stops at the greatest number. Where the point was
    /// moved to the grid's edge, (outside + moved)^2 - moved^2.
    #[inline(always)]
    fn squared_distances(
        &self,
        point: &GridPoint<P>,
        twice_out_of_grid: &GridPoint<P>,
    ) -> [u32; LANES] {
        let broadcast = |of: [u16; 2]| -> [u16; 2 * LANES] {
            bytemuck::cast([bytemuck::cast::<_, u32>(of); LANES])
        };
        let mut sums = [0u16; 2 * LANES];
        for (pair, (lows, highs)) in self.low.iter().zip(&self.high).enumerate() {
            let (points, twice) = (broadcast(point[pair]), broadcast(twice_out_of_grid[pair]));
            for i in 0..2 * LANES {
                // One of the two is 0.
                let outside =
                    lows[i].saturating_sub(points[i]) | points[i].saturating_sub(highs[i]);
                let other = outside.saturating_add(twice[i]);
                let square = (u32::from(outside) * u32::from(other)) >> 16;
                sums[i] = sums[i].saturating_add(square as u16);
            }
        }
        // Both halves, in whichever order.
        bytemuck::cast::<_, [u32; LANES]>(sums).map(|pair| (pair & 0xffff) + (pair >> 16))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernels::rng::{gaussian, random4};

    const D: usize = 11;

    /// Sixteen boxes of random sizes, and the corners of the box around them.
    fn boxes(seed: u32, scale: f32, centre: f32) -> ([[f32; LANES]; D], [[f32; LANES]; D]) {
        let noise =
            |d: usize, lane: usize, stream| gaussian(random4(seed, d as u32, lane as u32, stream));
        let low: [[f32; LANES]; D] =
            std::array::from_fn(|d| std::array::from_fn(|lane| centre + scale * noise(d, lane, 0)));
        let high = std::array::from_fn(|d| {
            std::array::from_fn(|lane| low[d][lane] + 0.3 * scale * noise(d, lane, 1).abs())
        });
        (low, high)
    }

    fn grid(
        low: &[[f32; LANES]; D],
        high: &[[f32; LANES]; D],
    ) -> QuantisationGrid<D, { D.div_ceil(2) }> {
        QuantisationGrid::enclosing(
            &low.map(|lanes| lanes.into_iter().fold(f32::INFINITY, f32::min)),
            &high.map(|lanes| lanes.into_iter().fold(f32::NEG_INFINITY, f32::max)),
        )
    }

    /// In f64, of numbers of f32.
    fn outside(
        low: &[[f32; LANES]; D],
        high: &[[f32; LANES]; D],
        at: &[f32; D],
        lane: usize,
    ) -> f64 {
        let square = |d: usize| {
            let [low, high, at] = [low[d][lane], high[d][lane], at[d]].map(f64::from);
            (low - at).max(at - high).max(0.0).powi(2)
        };
        (0..D).map(square).sum()
    }

    #[test]
    fn distances_are_never_greater_and_hardly_less() {
        for (seed, (scale, centre)) in [(1.0, 0.0), (1e-6, 0.0), (1e9, 0.0), (1e-3, 50.0)]
            .into_iter()
            .enumerate()
        {
            let (low, high) = boxes(seed as u32, scale, centre);
            let grid = grid(&low, &high);
            let quantised = grid.quantise_boxes(&low, &high);
            // What the greatest number stands for at least: the square of the grid's width.
            let most = (f64::from(u16::MAX) / f64::from(grid.resolution)).powi(2);
            for (query, away) in (0..400).zip([0.0, 0.5, 3.0, 1e3].into_iter().cycle()) {
                let noise = |d: usize| gaussian(random4(99, query, d as u32, 0)).clamp(-2.0, 2.0);
                let at: [f32; D] =
                    std::array::from_fn(|d| centre + scale * (1.0 + away) * noise(d));
                let out_of_grid = grid.out_of_grid(&at);
                let found = grid.squared_distances(&quantised, &grid.quantise(&at), &out_of_grid);
                for (lane, found) in found.into_iter().enumerate() {
                    let exact = outside(&low, &high, &at, lane);
                    let (found, unit) = (f64::from(found), f64::from(scale).powi(2));
                    assert!(found <= exact * (1.0 + 1e-5), "{found} of {exact}");
                    // Further away, twice the distance to the grid stops at the greatest number as well.
                    if away < 1.0 {
                        let exact = exact.min(most + f64::from(out_of_grid.squared));
                        assert!(found > 0.98 * exact - 0.02 * unit, "{found} of {exact}");
                    }
                }
            }
        }
    }

    #[test]
    fn boxes_around_one_point_bound_and_what_is_no_number_has_no_bound() {
        let point = [[0.25; LANES]; D];
        let grid = grid(&point, &point);
        let quantised = grid.quantise_boxes(&point, &point);
        for (at, square) in [(0.25, 0.0), (0.75, 0.25 * D as f32), (f32::NAN, 0.0)] {
            let at = [at; D];
            let found =
                grid.squared_distances(&quantised, &grid.quantise(&at), &grid.out_of_grid(&at));
            assert!(found.iter().all(|f| (f - square).abs() < 1e-6), "{found:?}");
        }
    }
}
