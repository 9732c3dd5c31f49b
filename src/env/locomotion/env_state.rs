//! The state of environments on the host.

use crate::container::{Section, SectionError};
use crate::kernels::locomotion::locomotion_layout::{
    MAP_WORDS, VELOCITY_DIM, boxes, state_f32, state_u32,
};

/// Everything that environments need to go on as if they had never stopped.
#[derive(Clone, Debug, PartialEq)]
pub struct EnvState {
    /// Steps so far: the counter of the random numbers.
    pub step_counter: u32,
    /// Level of the curriculum, from 0.
    pub level: u32,
    /// `[state_f32::FIELDS][envs]`
    pub state_f32: Vec<f32>,
    /// `[state_u32::FIELDS][envs]`
    pub state_u32: Vec<u32>,
    /// `[envs][boxes::FIELDS][count]`
    pub boxes: Vec<f32>,
    /// `[envs][VELOCITY_DIM][count]`
    pub obstacle_velocity: Vec<f32>,
    /// `[envs][MAP_WORDS]`
    pub maps: Vec<u32>,
}

impl EnvState {
    /// Writes it into a section of a checkpoint.
    pub fn save(&self, to: &mut Section) {
        to.put("step_counter", self.step_counter);
        to.put("level", self.level);
        to.put_array("state_f32", &self.state_f32);
        to.put_array("state_u32", &self.state_u32);
        to.put_array("boxes", &self.boxes);
        to.put_array("obstacle_velocity", &self.obstacle_velocity);
        to.put_array("maps", &self.maps);
    }

    /// Reads the state of `envs` environments with `count` obstacles each, which show frames of a
    /// database of `frames`.
    ///
    /// # Errors
    /// It is the state of others, or damaged.
    pub fn load(
        from: &mut Section,
        envs: usize,
        count: usize,
        frames: usize,
    ) -> Result<Self, SectionError> {
        let state = EnvState {
            step_counter: from.get("step_counter")?,
            level: from.get("level")?,
            state_f32: from.take_finite("state_f32", state_f32::FIELDS * envs)?,
            state_u32: from.take_array("state_u32", state_u32::FIELDS * envs)?,
            boxes: from.take_finite("boxes", envs * boxes::FIELDS * count)?,
            obstacle_velocity: from
                .take_finite("obstacle_velocity", envs * VELOCITY_DIM * count)?,
            maps: from.take_array("maps", envs * MAP_WORDS)?,
        };
        let shown = &state.state_u32[state_u32::FRAME * envs..][..envs];
        match shown.iter().find(|&&frame| frame as usize >= frames) {
            Some(frame) => Err(SectionError(format!(
                "it shows frame {frame} of a database of {frames}"
            ))),
            None => Ok(state),
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
