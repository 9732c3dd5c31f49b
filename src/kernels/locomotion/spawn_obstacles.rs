//! Draws the obstacles of new episodes. Shader: `shaders/locomotion/spawn_obstacles.wgsl`.

use super::locomotion_layout::{VELOCITY_DIM, boxes};
use crate::gpu::groups;
use crate::gpu::{Buffer, Gpu, shader};
use crate::kernels::rng::{gaussian, random4, uniform01};
use crate::kernels::termination;

crate::shader_params! {
    pub struct Params for spawn_obstacles {
        /// Environments of the batch.
        pub envs: u32,
        /// The first one's number in its batch: random numbers are drawn by it.
        pub first: u32,
        /// Obstacles of an environment.
        pub count: u32,
        /// Seed of the random numbers.
        pub seed: u32,
        /// Steps of the run so far: the random numbers' counter.
        pub step_counter: u32,
        /// Where this step's ends begin in `termination`.
        pub offset: u32,
        /// 1 to draw everywhere, whatever `termination` says.
        pub all: u32,
        /// Shortest side of a box, m; sides are drawn uniformly from there to `side_max`.
        pub side_min: f32,
        /// Longest side of a box, m.
        pub side_max: f32,
        /// Half the side of the square of their centres around the start, m.
        pub square: f32,
        /// Distance they keep from the start, m.
        pub margin: f32,
        /// Largest speed, m/s.
        pub speed: f32,
        /// Smallest speed as a share of the largest; 1 gives all the same.
        pub speed_min: f32,
    }
}

const BOXES: u32 = 0x424f_5853;
const DIRECTION: u32 = 1;
const PLACE: u32 = 3;
const TRIES: u32 = 29;

/// Queues the shader on `gpu`.
///
/// `termination` is `[envs]` from `params.offset` on, `boxes` `[envs][boxes::FIELDS][count]`,
/// `obstacle_velocity` `[envs][VELOCITY_DIM][count]`.
pub fn launch(
    gpu: &Gpu,
    termination: &Buffer<u32>,
    boxes: &Buffer<f32>,
    obstacle_velocity: &Buffer<f32>,
    params: &Params,
) {
    let groups = groups(
        &shader::SPAWN_OBSTACLES,
        (params.envs * params.count) as usize,
    );
    gpu.launch(
        &shader::SPAWN_OBSTACLES,
        groups,
        &[termination, boxes, obstacle_velocity],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(
    termination: &[u32],
    boxes: &mut [f32],
    obstacle_velocity: &mut [f32],
    params: &Params,
) {
    let count = params.count as usize;
    for env in 0..params.envs as usize {
        if params.all == 0 && termination[params.offset as usize + env] == termination::RUNNING {
            continue;
        }
        for slot in 0..count {
            let draw = |stream| {
                let stream = BOXES + 32 * slot as u32 + stream;
                random4(
                    params.seed,
                    params.first + env as u32,
                    params.step_counter,
                    stream,
                )
            };
            let size = draw(0);
            let range = params.side_max - params.side_min;
            let half =
                [size[0], size[1]].map(|bits| 0.5 * (params.side_min + uniform01(bits) * range));

            let centre = (0..TRIES)
                .map(|tried| {
                    let bits = draw(PLACE + tried);
                    [bits[0], bits[1]].map(|bits| (2.0 * uniform01(bits) - 1.0) * params.square)
                })
                .find(|place| (0..2).any(|i| place[i].abs() > half[i] + params.margin))
                .unwrap_or([params.square; 2]);

            let (east, north) = (gaussian(draw(DIRECTION)), gaussian(draw(DIRECTION + 1)));
            let length = (east * east + north * north).sqrt();
            let direction = match length > 1e-6 {
                true => [east / length, north / length],
                false => [0.0, 1.0],
            };
            let share = params.speed_min + uniform01(size[2]) * (1.0 - params.speed_min);
            let velocity = direction.map(|d| d * (params.speed * share));

            let values = [centre[0], centre[1], half[0], half[1]];
            for (field, value) in values.into_iter().enumerate() {
                boxes[(env * boxes::FIELDS + field) * count + slot] = value;
            }
            for (axis, value) in velocity.into_iter().enumerate() {
                obstacle_velocity[(env * VELOCITY_DIM + axis) * count + slot] = value;
            }
        }
    }
}
