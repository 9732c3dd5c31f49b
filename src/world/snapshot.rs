//! The state of worlds on the host.

use crate::kernels::layout::{real, whole};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Everything worlds need to go on as if never stopped.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Snapshot {
    /// Steps so far: the counter of the random numbers.
    pub clock: u32,
    pub level: u32,
    /// `[real::FIELDS][envs]`
    #[serde(skip)]
    pub real: Vec<f32>,
    /// `[whole::FIELDS][envs]`
    #[serde(skip)]
    pub whole: Vec<u32>,
    /// `[envs][boxes::FIELDS][count]`
    #[serde(skip)]
    pub boxes: Vec<f32>,
    /// `[envs][AXES][count]`
    #[serde(skip)]
    pub drift: Vec<f32>,
    /// `[envs][MAP_WORDS]`
    #[serde(skip)]
    pub maps: Vec<u32>,
}

impl Snapshot {
    fn envs(&self) -> usize {
        self.real.len() / real::FIELDS
    }

    /// Of the environments `envs` alone.
    pub fn part(&self, envs: Range<usize>) -> Snapshot {
        let all = self.envs();
        let envs: Vec<usize> = envs.collect();
        Snapshot {
            clock: self.clock,
            level: self.level,
            real: gather(&self.real, all, 1, &envs),
            whole: gather(&self.whole, all, 1, &envs),
            boxes: gather(&self.boxes, all, self.boxes.len() / all, &envs),
            drift: gather(&self.drift, all, self.drift.len() / all, &envs),
            maps: gather(&self.maps, all, self.maps.len() / all, &envs),
        }
    }

    /// Of all environments, from the parts they were cut into.
    pub fn join(parts: &[Snapshot]) -> Snapshot {
        Snapshot {
            clock: parts[0].clock,
            level: parts[0].level,
            real: fields(real::FIELDS, parts, |part| &part.real),
            whole: fields(whole::FIELDS, parts, |part| &part.whole),
            boxes: fields(1, parts, |part| &part.boxes),
            drift: fields(1, parts, |part| &part.drift),
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
