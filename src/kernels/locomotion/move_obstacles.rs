//! Moves the obstacles for one step. Shader: `shaders/locomotion/move_obstacles.wgsl`.

use super::locomotion_layout::{VELOCITY_DIM, boxes};
use super::obstacles::bounce;
use crate::gpu::groups;
use crate::gpu::{Buffer, Gpu, shader};
use rayon::prelude::*;

crate::shader_params! {
    pub struct Params for move_obstacles {
        /// Environments of the batch.
        pub envs: u32,
        /// Obstacles of an environment.
        pub count: u32,
        /// Seconds of a step.
        pub time: f32,
        /// Half the side of the square their centres stay in, m.
        pub square: f32,
    }
}

/// Queues the shader on `gpu`.
///
/// `boxes` is `[envs][boxes::FIELDS][count]`, `obstacle_velocity` `[envs][VELOCITY_DIM][count]`.
pub fn launch(gpu: &Gpu, boxes: &Buffer<f32>, obstacle_velocity: &Buffer<f32>, params: &Params) {
    let groups = groups(
        &shader::MOVE_OBSTACLES,
        (params.envs * params.count) as usize,
    );
    gpu.launch(
        &shader::MOVE_OBSTACLES,
        groups,
        &[boxes, obstacle_velocity],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(boxes: &mut [f32], obstacle_velocity: &mut [f32], params: &Params) {
    let count = params.count as usize;
    if count == 0 {
        return;
    }
    let worlds = boxes.par_chunks_mut(boxes::FIELDS * count);
    worlds
        .zip(obstacle_velocity.par_chunks_mut(VELOCITY_DIM * count))
        .take(params.envs as usize)
        .for_each(|(boxes, obstacle_velocity)| {
            // Both axes of a centre come first among a box's fields.
            for (place, velocity) in boxes.iter_mut().zip(obstacle_velocity) {
                (*place, *velocity) = bounce(*place, *velocity, params.time, params.square);
            }
        });
}
