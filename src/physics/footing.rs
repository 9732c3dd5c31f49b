//! The heights of a humanoid's feet, and motions set down on the ground by them.

use super::kinematics::kinematics;
use super::model::{Geom, JointKind, Model};
use super::pose::Pose;
use super::spatial::Spatial;

/// Share of the frames whose feet may be below the ground.
const BELOW: f32 = 0.01;

/// Somebody who moves on their feet touches the ground within this time before and after any moment, s.
const FLIGHT: f32 = 0.5;

/// What a humanoid stands on: the geoms of its feet.
pub struct Footing<'a> {
    model: &'a Model,
    /// Where the root's place is in the positions.
    root: usize,
    soles: Vec<&'a Geom>,
}

impl<'a> Footing<'a> {
    /// The footing of a model with a free pelvis and with geoms on its feet, or none.
    pub fn of(model: &'a Model) -> Option<Footing<'a>> {
        let pelvis = &model.bodies[model.body("pelvis")?];
        let root = model.joints[pelvis.joints.clone()].first()?;
        let feet = ["right_foot", "left_foot"].map(|name| model.body(name));
        let on_feet = |geom: &&Geom| geom.body.is_some() && feet.contains(&geom.body);
        let soles: Vec<&Geom> = model.geoms.iter().filter(on_feet).collect();
        (root.kind == JointKind::Free && !soles.is_empty()).then_some(Footing {
            model,
            root: root.q,
            soles,
        })
    }

    /// Height of the lowest point of either foot in each frame of `q`, `[frame][positions]`, m.
    pub fn heights(&self, q: &[f32]) -> Vec<f32> {
        let mut poses = vec![Pose::default(); self.model.bodies.len()];
        let mut axes = vec![Spatial::ZERO; self.model.nv()];
        let lowest = |q| {
            kinematics(self.model, q, &mut poses, &mut axes);
            let points = self.soles.iter().map(|geom| geom.lowest_point(&poses));
            points.fold(f32::INFINITY, f32::min)
        };
        q.chunks_exact(self.model.nq()).map(lowest).collect()
    }

    /// Puts the feet of `q`, `[frame][positions]`, on the ground: all but the lowest few.
    pub fn stand(&self, q: &mut [f32]) {
        let mut heights = self.heights(q);
        let ground = percentile(&mut heights, BELOW);
        self.lower(q, std::iter::repeat(ground));
    }

    /// Brings the feet of `q`, `[frame][positions]`, down or up to the ground wherever they are
    /// [believed](floor) to stand.
    pub fn ground(&self, q: &mut [f32], rate: f32) {
        let floor = floor(&self.heights(q), rate);
        self.lower(q, floor.into_iter());
    }

    /// Moves `q`, `[frame][positions]`, sideways so that it begins above the origin.
    pub fn begin_at_origin(&self, q: &mut [f32]) {
        let [x, y] = [q[self.root], q[self.root + 1]];
        for q in q.chunks_exact_mut(self.model.nq()) {
            q[self.root] -= x;
            q[self.root + 1] -= y;
        }
    }

    fn lower(&self, q: &mut [f32], by: impl Iterator<Item = f32>) {
        for (q, by) in q.chunks_exact_mut(self.model.nq()).zip(by) {
            q[self.root + 2] -= by;
        }
    }
}

/// Height of the floor under a motion in each frame, m, as the `heights` of its feet show it: the
/// lowest of half a second before and after, smoothed. It is never above the feet.
pub fn floor(heights: &[f32], rate: f32) -> Vec<f32> {
    let reach = (FLIGHT * rate) as usize;
    let least = around(heights, reach, |near| {
        near.iter().copied().fold(f32::INFINITY, f32::min)
    });
    // Each of these is the least of a stretch that holds the frame itself, and so is their mean.
    around(&least, reach, |near| {
        near.iter().sum::<f32>() / near.len() as f32
    })
}

/// Something of the values up to `reach` before and after each.
fn around(values: &[f32], reach: usize, of: impl Fn(&[f32]) -> f32) -> Vec<f32> {
    let last = values.len();
    let near = (0..last).map(|at| &values[at.saturating_sub(reach)..(at + reach + 1).min(last)]);
    near.map(of).collect()
}

/// The value below which so large a share of all values lies.
///
/// # Panics
/// There are no values.
pub fn percentile(values: &mut [f32], share: f32) -> f32 {
    let below = (share * values.len() as f32) as usize;
    let below = below.min(values.len() - 1);
    *values.select_nth_unstable_by(below, f32::total_cmp).1
}
