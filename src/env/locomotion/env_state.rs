//! The state of worlds on the host.

use crate::kernels::locomotion::locomotion_layout::{state_f32, state_u32};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Everything worlds need to go on as if never stopped.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EnvState {
    /// Steps so far: the counter of the random numbers.
    pub step_counter: u32,
    pub level: u32,
    /// `[state_f32::FIELDS][envs]`
    #[serde(skip)]
    pub state_f32: Vec<f32>,
    /// `[state_u32::FIELDS][envs]`
    #[serde(skip)]
    pub state_u32: Vec<u32>,
    /// `[envs][boxes::FIELDS][count]`
    #[serde(skip)]
    pub boxes: Vec<f32>,
    /// `[envs][VELOCITY_DIM][count]`
    #[serde(skip)]
    pub obstacle_velocity: Vec<f32>,
    /// `[envs][MAP_WORDS]`
    #[serde(skip)]
    pub maps: Vec<u32>,
}

impl EnvState {
    fn envs(&self) -> usize {
        self.state_f32.len() / state_f32::FIELDS
    }

    /// Of the environments `envs` alone.
    pub fn part(&self, envs: Range<usize>) -> EnvState {
        let all = self.envs();
        let envs: Vec<usize> = envs.collect();
        EnvState {
            step_counter: self.step_counter,
            level: self.level,
            state_f32: gather(&self.state_f32, all, 1, &envs),
            state_u32: gather(&self.state_u32, all, 1, &envs),
            boxes: gather(&self.boxes, all, self.boxes.len() / all, &envs),
            obstacle_velocity: gather(&self.obstacle_velocity, all, self.obstacle_velocity.len() / all, &envs),
            maps: gather(&self.maps, all, self.maps.len() / all, &envs),
        }
    }

    /// Of all environments, from the parts they were cut into.
    pub fn join(parts: &[EnvState]) -> EnvState {
        EnvState {
            step_counter: parts[0].step_counter,
            level: parts[0].level,
            state_f32: fields(state_f32::FIELDS, parts, |part| &part.state_f32),
            state_u32: fields(state_u32::FIELDS, parts, |part| &part.state_u32),
            boxes: fields(1, parts, |part| &part.boxes),
            obstacle_velocity: fields(1, parts, |part| &part.obstacle_velocity),
            maps: fields(1, parts, |part| &part.maps),
        }
    }
}

/// Rows of `width` values of the environments `envs`, from all `[..][old][width]`.
pub(super) fn gather<T: Copy>(all: &[T], old: usize, width: usize, envs: &[usize]) -> Vec<T> {
    let mut kept = Vec::with_capacity(all.len() / old * envs.len());
    for field in all.chunks_exact((old * width).max(1)) {
        for &env in envs {
            kept.extend_from_slice(&field[env * width..][..width]);
        }
    }
    kept
}

/// `[count][environments of all parts][..]` from `[count][environments of a part][..]`.
pub(super) fn fields<P, T: Copy>(count: usize, parts: &[P], values: impl Fn(&P) -> &[T]) -> Vec<T> {
    let of_part = |field: usize, part: &P| {
        let values = values(part);
        let length = values.len() / count;
        values[field * length..][..length].to_vec()
    };
    let order = (0..count).flat_map(|field| parts.iter().map(move |part| (field, part)));
    order
        .flat_map(|(field, part)| of_part(field, part))
        .collect()
}
