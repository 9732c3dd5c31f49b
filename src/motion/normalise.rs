//! Normalisation of features: one mean a dimension, one standard deviation and one weight a group.

use super::features::{FEATURE_DIM, POSE_DIM};
use serde::{Deserialize, Serialize};

/// Importance of each group of features in the search.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Weights {
    /// Positions of both feet.
    pub foot_position: f32,
    /// Velocities of both feet.
    pub foot_velocity: f32,
    /// Velocity of the root.
    pub root_velocity: f32,
    /// Future positions.
    pub trajectory_position: f32,
    /// Future directions.
    pub trajectory_direction: f32,
}

impl Weights {
    /// Weight 1 for all: the paper names none.
    pub const PAPER: Weights = Weights {
        foot_position: 1.0,
        foot_velocity: 1.0,
        root_velocity: 1.0,
        trajectory_position: 1.0,
        trajectory_direction: 1.0,
    };
    /// Daniel Holden's, of <https://github.com/orangeduck/Motion-Matching>.
    pub const HOLDEN: Weights = Weights {
        foot_position: 0.75,
        trajectory_direction: 1.5,
        ..Weights::PAPER
    };

    /// The weight of each group of dimensions.
    pub fn all(&self) -> [f32; GROUPS] {
        std::array::from_fn(|group| self.of(group))
    }

    fn of(&self, group: usize) -> f32 {
        match group {
            0 | 1 => self.foot_position,
            2 | 3 => self.foot_velocity,
            4 => self.root_velocity,
            5 => self.trajectory_position,
            _ => self.trajectory_direction,
        }
    }
}

/// Maps features between metres and the normalised space of the search:
/// `normalised = (feature - mean) * scale`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Normalisation {
    /// Mean of each dimension.
    pub mean: [f32; FEATURE_DIM],
    /// Weight over standard deviation, one for a group of dimensions.
    pub scale: [f32; FEATURE_DIM],
}

/// Each foot position, each foot velocity, root velocity, trajectory positions, directions.
const GROUPS: usize = 7;

fn group(dimension: usize) -> usize {
    if dimension < POSE_DIM {
        dimension / 3
    } else {
        5 + (dimension - POSE_DIM) % 4 / 2
    }
}

impl Normalisation {
    /// From the rows that can be matched. A group that never varies is left unscaled.
    pub fn of<'a>(rows: impl Iterator<Item = &'a [f32; FEATURE_DIM]>, weights: &Weights) -> Self {
        let (mut count, mut sum, mut square) = (0.0, [0.0f64; FEATURE_DIM], [0.0f64; FEATURE_DIM]);
        for row in rows {
            count += 1.0;
            for i in 0..FEATURE_DIM {
                let value = f64::from(row[i]);
                sum[i] += value;
                square[i] += value * value;
            }
        }
        let mean = sum.map(|s| s / count);
        let (mut variance, mut members) = ([0.0; GROUPS], [0.0; GROUPS]);
        for i in 0..FEATURE_DIM {
            variance[group(i)] += (square[i] / count - mean[i] * mean[i]).max(0.0);
            members[group(i)] += 1.0;
        }
        let scale = std::array::from_fn(|i| {
            let std_dev = (variance[group(i)] / members[group(i)]).sqrt();
            let std_dev = if std_dev > 1e-6 { std_dev as f32 } else { 1.0 };
            weights.of(group(i)) / std_dev
        });
        Normalisation {
            mean: mean.map(|m| m as f32),
            scale,
        }
    }

    /// Mean, then scale of the trajectory features: `[2][TRAJECTORY_DIM]`.
    pub fn trajectory(&self) -> Vec<f32> {
        [&self.mean[POSE_DIM..], &self.scale[POSE_DIM..]].concat()
    }

    /// A row in the normalised space.
    pub fn apply(&self, row: &[f32; FEATURE_DIM]) -> [f32; FEATURE_DIM] {
        std::array::from_fn(|i| (row[i] - self.mean[i]) * self.scale[i])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dimensions_fall_into_their_groups() {
        assert_eq!(
            (0..FEATURE_DIM).map(group).collect::<Vec<_>>(),
            [
                0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4, 4, 5, 5, 6, 6, 5, 5, 6, 6, 5, 5, 6, 6
            ]
        );
    }

    #[test]
    fn the_mean_variance_of_a_group_becomes_the_squared_weight() {
        let rows: Vec<[f32; FEATURE_DIM]> = (0..200)
            .map(|k| std::array::from_fn(|i| ((k * (i + 3)) % 17) as f32 * (i as f32 + 1.0)))
            .collect();
        let normalisation = Normalisation::of(rows.iter(), &Weights::HOLDEN);
        let normal: Vec<_> = rows.iter().map(|row| normalisation.apply(row)).collect();
        for g in 0..GROUPS {
            let members: Vec<usize> = (0..FEATURE_DIM).filter(|&i| group(i) == g).collect();
            let mut variance = 0.0;
            for &i in &members {
                let mean = normal.iter().map(|row| row[i]).sum::<f32>() / 200.0;
                assert!(mean.abs() < 1e-4);
                variance += normal
                    .iter()
                    .map(|row| (row[i] - mean).powi(2))
                    .sum::<f32>()
                    / 200.0;
            }
            let weight = Weights::HOLDEN.of(g);
            assert!((variance / members.len() as f32 - weight * weight).abs() < 1e-3);
        }
    }
}
