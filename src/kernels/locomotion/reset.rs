//! Starts new episodes. Shader: `shaders/locomotion/reset.wgsl`.

use super::hits::obstructed;
use super::locomotion_layout::{boxes, state_f32, state_u32};
use crate::gpu::groups;
use crate::gpu::{Buffer, Gpu, shader};
use crate::kernels::rng::{gaussian, index_below, random4, uniform01};
use crate::kernels::termination;

crate::shader_params! {
    pub struct Params for reset {
        /// Environments of the batch.
        pub envs: u32,
        /// The first one's number in its batch: random numbers are drawn by it.
        pub first: u32,
        /// Candidates of the database; an episode begins at one of them.
        pub candidates: u32,
        /// Obstacles of an environment.
        pub count: u32,
        /// Seed of the random numbers.
        pub seed: u32,
        /// Steps of the run so far: the random numbers' counter.
        pub step_counter: u32,
        /// Where this step's ends begin in `termination`.
        pub offset: u32,
        /// 1 to start everywhere, whatever `termination` says.
        pub all: u32,
        /// Steps after which an episode is truncated, less a random number below
        /// `initial_age_jitter`.
        pub max_steps: u32,
        /// Bound, exclusive, of the random number by which limits differ, steps; 0 for none.
        pub initial_age_jitter: u32,
        /// Half the side of the square of targets around the start, m.
        pub half_side: f32,
        /// Targets are farther than this, m.
        pub reach: f32,
        /// 1: targets lie in no obstacle.
        pub clear: u32,
    }
}

const START: u32 = 0;
const TARGET: u32 = 1;
const DRAWS: u32 = 32;

/// Queues the shader on `gpu`.
///
/// `candidates` is `[candidates]`, the database frame of each; `termination` `[envs]` from
/// `params.offset` on, `boxes` `[envs][boxes::FIELDS][count]`. `state_f32` is
/// `[state_f32::FIELDS][envs]`, `state_u32` `[state_u32::FIELDS][envs]`.
pub fn launch(
    gpu: &Gpu,
    candidates: &Buffer<u32>,
    termination: &Buffer<u32>,
    boxes: &Buffer<f32>,
    state_f32: &Buffer<f32>,
    state_u32: &Buffer<u32>,
    params: &Params,
) {
    gpu.launch(
        &shader::RESET,
        groups(&shader::RESET, params.envs as usize),
        &[candidates, termination, boxes, state_f32, state_u32],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(
    candidates: &[u32],
    termination: &[u32],
    boxes: &[f32],
    state_f32: &mut [f32],
    state_u32: &mut [u32],
    params: &Params,
) {
    let envs = params.envs as usize;
    for env in 0..envs {
        if params.all == 0 && termination[params.offset as usize + env] == termination::RUNNING {
            continue;
        }
        let draw = |stream| {
            random4(
                params.seed,
                params.first + env as u32,
                params.step_counter,
                stream,
            )
        };
        let [first, early, ..] = draw(START);
        let start = index_below(first, params.candidates);
        state_u32[state_u32::FRAME * envs + env] = candidates[start as usize];
        state_u32[state_u32::EPISODE_STEP * envs + env] = 0;
        state_u32[state_u32::EPISODE_LIMIT * envs + env] =
            params.max_steps - index_below(early, params.initial_age_jitter);

        let (east, north) = (gaussian(draw(START + 2)), gaussian(draw(START + 3)));
        let length = (east * east + north * north).sqrt();
        let heading = if length > 1e-6 {
            [east / length, north / length]
        } else {
            [0.0, 1.0]
        };

        let count = params.count as usize;
        let boxes = &boxes[env * boxes::FIELDS * count..][..boxes::FIELDS * count];
        let target = (0..DRAWS)
            .map(|tried| {
                let bits = draw(TARGET + 4 * (tried + 1));
                [bits[0], bits[1]].map(|bits| (2.0 * uniform01(bits) - 1.0) * params.half_side)
            })
            .find(|&[x, z]| {
                let far = x * x + z * z > params.reach * params.reach;
                far && (params.clear == 0 || !obstructed([x, z], boxes, count))
            })
            .unwrap_or([params.half_side; 2]);

        let values = [
            (state_f32::X, 0.0),
            (state_f32::Z, 0.0),
            (state_f32::HEADING_X, heading[0]),
            (state_f32::HEADING_Z, heading[1]),
            (state_f32::TARGET_X, target[0]),
            (state_f32::TARGET_Z, target[1]),
            (state_f32::RETURN, 0.0),
            (state_f32::TRAVELLED, 0.0),
        ];
        for (field, value) in values {
            state_f32[field * envs + env] = value;
        }
    }
}
