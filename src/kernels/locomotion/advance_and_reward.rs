//! Plays six frames, rewards and ends. Shader: `shaders/locomotion/advance_and_reward.wgsl`.

use super::locomotion_layout::{state_f32, state_u32};
use crate::gpu::groups;
use crate::gpu::{Buffer, Gpu, shader};
use crate::kernels::termination;
use crate::motion::character_frame::to_world;
use crate::motion::database::RootMotion;
use crate::motion::features::FRAMES_PER_STEP;

crate::shader_params! {
    pub struct Params for advance_and_reward {
        /// Environments of the batch.
        pub envs: u32,
        /// Where this step's rewards and ends begin.
        pub offset: u32,
        /// Distance at which the target counts as reached, m.
        pub reach: f32,
        /// Reward for being near the target: times exp(-distance).
        pub near: f32,
        /// Reward a metre nearer to the target.
        pub progress: f32,
        /// Reward for asking for clear ground: times exp(-hits) - shift.
        pub clear: f32,
        /// What is taken from exp(-hits): 1 turns that reward into a penalty, 0 leaves it a reward.
        pub shift: f32,
        /// Reward on arrival.
        pub bonus: f32,
        /// Reward on a collision, not above 0.
        pub crash: f32,
    }
}

/// Queues the shader on `gpu`.
///
/// `candidates` is `[candidates]`, the database frame of each; `matched` `[envs]`, the candidate
/// found by the search; `motion` `[candidates][5]`, the numbers of each [`RootMotion`], in the
/// character frame. `state_f32` is `[state_f32::FIELDS][envs]`, `state_u32`
/// `[state_u32::FIELDS][envs]`; `reward` and `termination` take `[envs]` from `params.offset` on.
pub fn launch(
    gpu: &Gpu,
    candidates: &Buffer<u32>,
    matched: &Buffer<u32>,
    motion: &Buffer<f32>,
    state_f32: &Buffer<f32>,
    state_u32: &Buffer<u32>,
    reward: &Buffer<f32>,
    termination: &Buffer<u32>,
    params: &Params,
) {
    let groups = groups(&shader::ADVANCE_AND_REWARD, params.envs as usize);
    gpu.launch(
        &shader::ADVANCE_AND_REWARD,
        groups,
        &[
            candidates,
            matched,
            motion,
            state_f32,
            state_u32,
            reward,
            termination,
        ],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(
    candidates: &[u32],
    matched: &[u32],
    motion: &[RootMotion],
    state_f32: &mut [f32],
    state_u32: &mut [u32],
    reward: &mut [f32],
    termination: &mut [u32],
    params: &Params,
) {
    let envs = params.envs as usize;
    let offset = params.offset as usize;
    for env in 0..envs {
        let played = &motion[matched[env] as usize];
        let r = |field: usize| field * envs + env;
        let heading = [
            state_f32[r(state_f32::HEADING_X)],
            state_f32[r(state_f32::HEADING_Z)],
        ];
        let moved = to_world(played.moved, heading);
        let turned = to_world(played.turned, heading);
        let length = (turned[0] * turned[0] + turned[1] * turned[1]).sqrt();
        let before = [state_f32[r(state_f32::X)], state_f32[r(state_f32::Z)]];
        let at = [before[0] + moved[0], before[1] + moved[1]];
        state_f32[r(state_f32::X)] = at[0];
        state_f32[r(state_f32::Z)] = at[1];
        state_f32[r(state_f32::HEADING_X)] = turned[0] / length;
        state_f32[r(state_f32::HEADING_Z)] = turned[1] / length;
        state_f32[r(state_f32::TRAVELLED)] += played.length;
        state_u32[r(state_u32::FRAME)] = candidates[matched[env] as usize] + FRAMES_PER_STEP as u32;

        let age = state_u32[r(state_u32::EPISODE_STEP)] + 1;
        state_u32[r(state_u32::EPISODE_STEP)] = age;
        let goal = [
            state_f32[r(state_f32::TARGET_X)],
            state_f32[r(state_f32::TARGET_Z)],
        ];
        let from = |place: [f32; 2]| {
            let (dx, dz) = (goal[0] - place[0], goal[1] - place[1]);
            (dx * dx + dz * dz).sqrt()
        };
        let distance = from(at);
        let approached = from(before) - distance;
        let hits = state_u32[r(state_u32::HITS)] as f32;
        let walked = params.near * (-distance).exp()
            + params.progress * approached
            + params.clear * ((-hits).exp() - params.shift);
        let (end, gained) = if state_u32[r(state_u32::HAS_COLLIDED)] == 1 {
            (termination::FAILED, walked + params.crash)
        } else if distance <= params.reach {
            (termination::SUCCESS, walked + params.bonus)
        } else if age >= state_u32[r(state_u32::EPISODE_LIMIT)] {
            (termination::TRUNCATED, walked)
        } else {
            (termination::RUNNING, walked)
        };
        reward[offset + env] = gained;
        termination[offset + env] = end;
        let total = state_f32[r(state_f32::RETURN)] + gained;
        state_f32[r(state_f32::RETURN)] = total;
        if end != termination::RUNNING {
            state_f32[r(state_f32::RETURNS)] += total;
            state_u32[r(state_u32::EPISODES)] += 1;
            state_u32[r(state_u32::SUCCESSES)] += u32::from(end == termination::SUCCESS);
            state_u32[r(state_u32::COLLISIONS)] += u32::from(end == termination::FAILED);
            state_u32[r(state_u32::TRUNCATIONS)] += u32::from(end == termination::TRUNCATED);
            state_u32[r(state_u32::LENGTHS)] += age;
        }
    }
}
