//! A map of the sphere of latents: what a body does under which of them.

use super::sphere::{across, any_across, combined, dot, principal_axes};
use crate::env::humanoid::driver::BodyDriver;
use crate::env::humanoid::fidelity::COMPARED;
use crate::env::humanoid::skills::clips_under;
use crate::kernels::learn::advance_latents::to_sphere;
use crate::physics::motion_library::MotionLibrary;
use crate::rl::ase::LatentDraw;
use crate::train::body_episodes::BodyEpisodes;
use std::f32::consts::PI;

/// How many latents decide on the axes where clips have none.
const RANDOM: usize = COMPARED;
/// Latents all over the disc besides.
const SPREAD: usize = 2 * COMPARED;

/// The sphere of latents, seen along all but its two main directions: a disc, every point of which is a latent.
pub struct LatentMap {
    axes: [Vec<f32>; 2],
    /// Latents of which it is known what the body does.
    pub points: Vec<MapPoint>,
    /// The clips that it moves like somewhere, the most frequent first.
    pub legend: Vec<String>,
}

/// A latent of which it is known what the body does.
pub struct MapPoint {
    /// A vector of length 1.
    pub latent: Vec<f32>,
    /// The clip that it moves like, by its index in the legend; `None` if it falls.
    pub clip: Option<usize>,
    /// The clip whose latent it is, if it is one's.
    pub own: Option<String>,
}

impl LatentMap {
    /// Plays episodes under many latents, to see which of the library's clips a body moves like.
    pub fn new(
        episodes: &BodyEpisodes,
        library: &MotionLibrary,
        draw: &LatentDraw,
        driver: &dyn BodyDriver,
    ) -> LatentMap {
        let own: Vec<Vec<f32>> = draw.clips().map(<[f32]>::to_vec).collect();
        let clips_of = |latents: &[Vec<f32>]| clips_of(episodes, library, driver, latents);
        let count = own.len();
        let first = if count == 0 { draw.any(RANDOM) } else { own };
        let known = clips_of(&first);
        let axes = match count {
            0 => principal_axes(&means(&first, &known)),
            _ => principal_axes(&first),
        };
        let spread = spread(&axes, &draw.any(SPREAD));
        let clips = [known, clips_of(&spread)].concat();
        let latents = [first, spread].concat();
        let order = by_frequency(&clips);
        let name = |clip: usize| library.motions()[clip].name.clone();
        let entry = |clip: usize| order.iter().position(|&other| other == clip);
        let points = latents.into_iter().zip(clips).enumerate();
        let points = points.map(|(number, (latent, clip))| MapPoint {
            latent,
            clip: clip.and_then(entry),
            own: (number < count).then(|| name(number)),
        });
        LatentMap {
            points: points.collect(),
            legend: order.iter().map(|&clip| name(clip)).collect(),
            axes,
        }
    }

    /// Where a latent is on the disc of radius 1.
    pub fn place(&self, latent: &[f32]) -> [f32; 2] {
        [0, 1].map(|axis| dot(&self.axes[axis], latent))
    }

    /// The latent of a point of the disc: along the main directions it is there, across them it is as the `present`
    /// one. What is beside the disc stands for its edge.
    pub fn latent(&self, at: [f32; 2], present: &[f32]) -> Vec<f32> {
        lift(&self.axes, at, present)
    }

    /// The known latent that is nearest to a point of the disc, if that is within reach.
    pub fn near(&self, at: [f32; 2], reach: f32) -> Option<&MapPoint> {
        let far = |point: &MapPoint| {
            let [x, y] = self.place(&point.latent);
            (x - at[0]).hypot(y - at[1])
        };
        let points = self.points.iter().map(|point| (point, far(point)));
        let nearest = points.min_by(|a, b| a.1.total_cmp(&b.1));
        nearest
            .filter(|(_, far)| *far <= reach)
            .map(|(point, _)| point)
    }
}

/// The clip that a body moves like under each latent.
fn clips_of(
    episodes: &BodyEpisodes,
    library: &MotionLibrary,
    driver: &dyn BodyDriver,
    latents: &[Vec<f32>],
) -> Vec<Option<usize>> {
    let batches = latents.chunks(COMPARED).flat_map(|latents| {
        let mut envs = episodes.open_all(latents.len());
        clips_under(&mut envs, library, driver, latents.concat())
    });
    batches.collect()
}

fn lift(axes: &[Vec<f32>; 2], at: [f32; 2], present: &[f32]) -> Vec<f32> {
    let [first, second] = axes.each_ref().map(|axis| &axis[..]);
    let scale = 1.0 / at[0].hypot(at[1]).max(1.0);
    let [x, y] = at.map(|along| scale * along);
    let along = combined([x, y], [first, second]);
    let axes = [first, second];
    let rest = across(present, &axes).or_else(|| any_across(first.len(), &axes));
    let height = (1.0 - x * x - y * y).max(0.0).sqrt();
    let mut latent = match rest {
        Some(rest) => combined([1.0, height], [&along, &rest]),
        // A circle has no inside.
        None => along,
    };
    to_sphere(&mut latent);
    latent
}

/// Latents all over the disc, as the seeds of a sunflower are; across the main directions they are as `others`.
fn spread(axes: &[Vec<f32>; 2], others: &[Vec<f32>]) -> Vec<Vec<f32>> {
    let golden = PI * (3.0 - 5.0f32.sqrt());
    let latent = |(seed, other): (usize, &Vec<f32>)| {
        let radius = ((seed as f32 + 0.5) / others.len() as f32).sqrt();
        let (sin, cos) = (golden * seed as f32).sin_cos();
        lift(axes, [radius * cos, radius * sin], other)
    };
    others.iter().enumerate().map(latent).collect()
}

/// The mean of all latents under which a body moves like the same clip.
fn means(latents: &[Vec<f32>], clips: &[Option<usize>]) -> Vec<Vec<f32>> {
    let mean = |clip: &Option<usize>| {
        let such = latents
            .iter()
            .zip(clips)
            .filter(|(_, other)| *other == clip);
        let such: Vec<&[f32]> = such.map(|(latent, _)| &latent[..]).collect();
        let part = 1.0 / such.len() as f32;
        let none = vec![0.0; latents[0].len()];
        such.iter()
            .fold(none, |sum, latent| combined([1.0, part], [&sum, latent]))
    };
    let mut different = clips.to_vec();
    different.sort_unstable();
    different.dedup();
    different.iter().map(mean).collect()
}

/// The clips that occur, the most frequent first.
fn by_frequency(clips: &[Option<usize>]) -> Vec<usize> {
    let count = |clip: usize| clips.iter().filter(|other| **other == Some(clip)).count();
    let mut different: Vec<usize> = clips.iter().flatten().copied().collect();
    different.sort_unstable();
    different.dedup();
    different.sort_by_key(|&clip| std::cmp::Reverse(count(clip)));
    different
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map() -> LatentMap {
        let vectors: Vec<Vec<f32>> = (0..6)
            .map(|number| {
                let mut vector: Vec<f32> = (0..5)
                    .map(|at| ((3 * number + 2 * at) as f32).sin())
                    .collect();
                to_sphere(&mut vector);
                vector
            })
            .collect();
        let point = |latent: &Vec<f32>| MapPoint {
            latent: latent.clone(),
            clip: None,
            own: None,
        };
        LatentMap {
            axes: principal_axes(&vectors),
            points: vectors.iter().map(point).collect(),
            legend: Vec::new(),
        }
    }

    #[test]
    fn the_latent_of_a_point_is_of_length_1_and_where_the_point_is() {
        let map = map();
        let points = [[0.0, 0.0], [0.3, -0.4], [-0.9, 0.1], [0.6, 0.8]];
        // The latent that is there already, one within the map's plane, and none at all.
        let presents = [
            map.points[2].latent.clone(),
            map.axes[0].clone(),
            Vec::new(),
        ];
        for (at, present) in points
            .iter()
            .flat_map(|at| presents.iter().map(move |p| (at, p)))
        {
            let latent = map.latent(*at, present);
            assert!((dot(&latent, &latent) - 1.0).abs() < 1e-5, "{at:?}");
            let [x, y] = map.place(&latent);
            assert!((x - at[0]).hypot(y - at[1]) < 1e-5, "{at:?}: {x} {y}");
        }
        // Beside the disc.
        let [x, y] = map.place(&map.latent([3.0, 4.0], &presents[0]));
        assert!((x - 0.6).hypot(y - 0.8) < 1e-5);
    }

    #[test]
    fn a_latent_stays_what_it_is_where_it_is_already() {
        let map = map();
        let latent = &map.points[4].latent;
        let again = map.latent(map.place(latent), latent);
        assert!((dot(latent, &again) - 1.0).abs() < 1e-5);
        let point = map.near(map.place(latent), 0.01).unwrap();
        assert_eq!(&point.latent, latent);
        assert!(map.near([2.0, 2.0], 0.1).is_none());
    }

    #[test]
    fn latents_are_spread_all_over_the_disc() {
        let map = map();
        let others = vec![map.points[0].latent.clone(); 100];
        let places = spread(&map.axes, &others);
        let quarter = |x: f32, y: f32| {
            let places = places.iter().map(|latent| map.place(latent));
            places
                .filter(|at| at[0] * x > 0.0 && at[1] * y > 0.0)
                .count()
        };
        for (x, y) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            assert!((20..=30).contains(&quarter(x, y)), "{x} {y}");
        }
    }

    #[test]
    fn clips_are_put_in_order_and_latents_averaged_by_clip() {
        let clips = [Some(4), None, Some(2), Some(4)];
        assert_eq!(by_frequency(&clips), [4, 2]);
        let latents: Vec<Vec<f32>> = [1.0, 5.0, 2.0, 3.0].iter().map(|&x| vec![x]).collect();
        assert_eq!(means(&latents, &clips), [[5.0], [2.0], [2.0]]);
    }
}
