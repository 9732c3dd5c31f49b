//! Boxes in whole numbers of sixteen bits: half the memory of others, and twice as many at a time.
//!
//! Boxes are widened to the grid, and what lies outside it is moved to its edge: both make distances
//! only less. What moving leaves out is known ([`Beyond`]).

use super::tree::LANES;
use crate::motion::features::{POSE_DIM, TRAJECTORY_DIM};

/// Where `D` dimensions lie in whole numbers, `P` pairs of them.
pub struct Grid<const D: usize, const P: usize> {
    /// The corner of zeros.
    origin: [f32; D],
    /// Whole numbers a unit.
    fine: f32,
}

/// Of the trajectory and of the pose.
pub const TRAJECTORY_PAIRS: usize = TRAJECTORY_DIM.div_ceil(2);
pub const POSE_PAIRS: usize = POSE_DIM.div_ceil(2);

/// A place on a grid, or, of what has an odd number of dimensions, a 0 behind it.
pub type Place<const P: usize> = [[u16; 2]; P];
/// Corners of sixteen boxes, in pairs of dimensions, so that the two of a place that belong to them are
/// one number of 32 bits, which processors spread to all lanes while they load it.
pub type Corners<const P: usize> = [[u16; 2 * LANES]; P];

/// What a place leaves out of what lies outside the grid.
pub struct Beyond<const P: usize> {
    /// In whole numbers, twice.
    twice: Place<P>,
    /// All of it, squared.
    pub square: f32,
}

impl<const P: usize> Beyond<P> {
    pub const NOTHING: Self = Beyond {
        twice: [[0; 2]; P],
        square: 0.0,
    };
}

/// Sixteen boxes on a grid.
#[repr(align(64))]
pub struct Rounded<const P: usize> {
    pub low: Corners<P>,
    pub high: Corners<P>,
}

/// The grid's width, of that of what it is made for: queries may lie beside that.
const ROOM: f32 = 1.5;

impl<const D: usize, const P: usize> Grid<D, P> {
    /// Around a box.
    pub fn around(low: &[f32; D], high: &[f32; D]) -> Self {
        let widths = low.iter().zip(high).map(|(low, high)| high - low);
        // Of a point any width would do but 0.
        let width = ROOM * widths.fold(1e-15, f32::max);
        Grid {
            origin: std::array::from_fn(|d| 0.5 * (low[d] + high[d]) - 0.5 * width),
            fine: f32::from(u16::MAX) / width,
        }
    }

    /// Off by half a number, and by what rounding adds to that: a hundredth.
    #[inline(always)]
    pub fn place(&self, values: &[f32]) -> Place<P> {
        let mut place = [[0; 2]; P];
        let all = place.as_flattened_mut().iter_mut();
        for ((place, value), origin) in all.zip(values).zip(self.origin) {
            *place = ((value - origin) * self.fine + 0.5) as u16;
        }
        place
    }

    /// How far outside the grid values are.
    #[inline(always)]
    pub fn beyond(&self, values: &[f32]) -> Beyond<P> {
        let mut beyond = Beyond::NOTHING;
        let width = f32::from(u16::MAX) / self.fine;
        let all = beyond.twice.as_flattened_mut().iter_mut();
        for ((twice, value), origin) in all.zip(values).zip(self.origin) {
            let away = (origin - value).max(value - origin - width).max(0.0);
            *twice = (2.0 * away * self.fine) as u16;
            beyond.square += away * away;
        }
        beyond
    }

    /// Boxes are wider by a number on each side: more than what is looked for can be off. Where there is
    /// no box (infinity), there are no rows, and its distance does not matter.
    pub fn widen(&self, low: &[[f32; LANES]; D], high: &[[f32; LANES]; D]) -> Rounded<P> {
        Rounded {
            low: self.corners(low, -1.0),
            high: self.corners(high, 2.0),
        }
    }

    fn corners(&self, of: &[[f32; LANES]; D], more: f32) -> Corners<P> {
        // All places behind the last dimension are 0, and so is the distance to these corners.
        let mut corners = [[0; 2 * LANES]; P];
        for (d, values) in of.iter().enumerate() {
            for (lane, value) in values.iter().enumerate() {
                let place = (value - self.origin[d]) * self.fine + more;
                corners[d / 2][2 * lane + d % 2] = place as u16;
            }
        }
        corners
    }

    /// Where a corner of a box lies.
    pub fn corner(&self, corners: &Corners<P>, lane: usize) -> [f32; D] {
        std::array::from_fn(|d| {
            self.origin[d] + f32::from(corners[d / 2][2 * lane + d % 2]) / self.fine
        })
    }

    /// Squared distances to boxes at least.
    #[inline(always)]
    pub fn outside(
        &self,
        boxes: &Rounded<P>,
        place: &Place<P>,
        beyond: &Beyond<P>,
    ) -> [f32; LANES] {
        let unit = 65536.0 / (self.fine * self.fine);
        let inside = boxes.outside(place, &beyond.twice);
        inside.map(|outside| outside as f32 * unit + beyond.square)
    }
}

impl<const P: usize> Rounded<P> {
    /// Squared distances at least, in units of 65536: what a dimension has less than that is left out,
    /// and what there is more than fits stops at the greatest number. Of a place that lies `beyond` its
    /// own, (outside + beyond)^2 - beyond^2.
    #[inline(always)]
    fn outside(&self, place: &Place<P>, twice_beyond: &Place<P>) -> [u32; LANES] {
        let spread = |of: [u16; 2]| -> [u16; 2 * LANES] {
            bytemuck::cast([bytemuck::cast::<_, u32>(of); LANES])
        };
        let mut sums = [0u16; 2 * LANES];
        for (pair, (lows, highs)) in self.low.iter().zip(&self.high).enumerate() {
            let (places, twice) = (spread(place[pair]), spread(twice_beyond[pair]));
            for i in 0..2 * LANES {
                // One of the two is 0.
                let outside =
                    lows[i].saturating_sub(places[i]) | places[i].saturating_sub(highs[i]);
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

    fn grid(low: &[[f32; LANES]; D], high: &[[f32; LANES]; D]) -> Grid<D, { D.div_ceil(2) }> {
        Grid::around(
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
            let rounded = grid.widen(&low, &high);
            // What the greatest number stands for at least: the square of the grid's width.
            let most = (f64::from(u16::MAX) / f64::from(grid.fine)).powi(2);
            for (query, away) in (0..400).zip([0.0, 0.5, 3.0, 1e3].into_iter().cycle()) {
                let noise = |d: usize| gaussian(random4(99, query, d as u32, 0)).clamp(-2.0, 2.0);
                let at: [f32; D] =
                    std::array::from_fn(|d| centre + scale * (1.0 + away) * noise(d));
                let beyond = grid.beyond(&at);
                let found = grid.outside(&rounded, &grid.place(&at), &beyond);
                for (lane, found) in found.into_iter().enumerate() {
                    let exact = outside(&low, &high, &at, lane);
                    let (found, unit) = (f64::from(found), f64::from(scale).powi(2));
                    assert!(found <= exact * (1.0 + 1e-5), "{found} of {exact}");
                    // Further away, what is twice beyond stops at the greatest number as well.
                    if away < 1.0 {
                        let exact = exact.min(most + f64::from(beyond.square));
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
        let rounded = grid.widen(&point, &point);
        for (at, square) in [(0.25, 0.0), (0.75, 0.25 * D as f32), (f32::NAN, 0.0)] {
            let at = [at; D];
            let found = grid.outside(&rounded, &grid.place(&at), &grid.beyond(&at));
            assert!(found.iter().all(|f| (f - square).abs() < 1e-6), "{found:?}");
        }
    }
}
