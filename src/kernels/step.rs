//! Plays six frames, rewards and ends. Shader: `shaders/world/step.wgsl`.

use super::layout::{end, real, whole};
use crate::gpu::kernel::groups;
use crate::gpu::{Buffer, Gpu, shader};
use crate::motion::database::RootMotion;
use crate::motion::features::PLAYED;
use crate::motion::frame::to_world;

crate::shader_params! {
    pub struct Params for step {
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
        pub shift: f32,
        /// Reward on arrival.
        pub bonus: f32,
        /// Reward on a collision, not above 0.
        pub crash: f32,
    }
}

pub fn launch(
    gpu: &Gpu,
    candidates: &Buffer<u32>,
    matched: &Buffer<u32>,
    motion: &Buffer<f32>,
    real: &Buffer<f32>,
    whole: &Buffer<u32>,
    reward: &Buffer<f32>,
    ended: &Buffer<u32>,
    params: &Params,
) {
    let groups = groups(&shader::STEP, params.envs as usize);
    gpu.launch(
        &shader::STEP,
        groups,
        &[candidates, matched, motion, real, whole, reward, ended],
        params,
    );
}

pub fn twin(
    candidates: &[u32],
    matched: &[u32],
    motion: &[RootMotion],
    real: &mut [f32],
    whole: &mut [u32],
    reward: &mut [f32],
    ended: &mut [u32],
    params: &Params,
) {
    let envs = params.envs as usize;
    let offset = params.offset as usize;
    for env in 0..envs {
        let played = &motion[matched[env] as usize];
        let r = |field: usize| field * envs + env;
        let heading = [real[r(real::HEADING_X)], real[r(real::HEADING_Z)]];
        let moved = to_world(played.moved, heading);
        let turned = to_world(played.turned, heading);
        let length = (turned[0] * turned[0] + turned[1] * turned[1]).sqrt();
        let before = [real[r(real::X)], real[r(real::Z)]];
        let at = [before[0] + moved[0], before[1] + moved[1]];
        real[r(real::X)] = at[0];
        real[r(real::Z)] = at[1];
        real[r(real::HEADING_X)] = turned[0] / length;
        real[r(real::HEADING_Z)] = turned[1] / length;
        real[r(real::TRAVELLED)] += played.length;
        whole[r(whole::FRAME)] = candidates[matched[env] as usize] + PLAYED as u32;

        let age = whole[r(whole::AGE)] + 1;
        whole[r(whole::AGE)] = age;
        let goal = [real[r(real::TARGET_X)], real[r(real::TARGET_Z)]];
        let from = |place: [f32; 2]| {
            let (dx, dz) = (goal[0] - place[0], goal[1] - place[1]);
            (dx * dx + dz * dz).sqrt()
        };
        let distance = from(at);
        let approached = from(before) - distance;
        let hits = whole[r(whole::HITS)] as f32;
        let walked = params.near * (-distance).exp()
            + params.progress * approached
            + params.clear * ((-hits).exp() - params.shift);
        let (end, gained) = if whole[r(whole::STRUCK)] == 1 {
            (end::COLLIDED, walked + params.crash)
        } else if distance <= params.reach {
            (end::REACHED, walked + params.bonus)
        } else if age >= whole[r(whole::LIMIT)] {
            (end::TRUNCATED, walked)
        } else {
            (end::RUNNING, walked)
        };
        reward[offset + env] = gained;
        ended[offset + env] = end;
        let total = real[r(real::RETURN)] + gained;
        real[r(real::RETURN)] = total;
        if end != end::RUNNING {
            real[r(real::RETURNS)] += total;
            whole[r(whole::EPISODES)] += 1;
            whole[r(whole::SUCCESSES)] += u32::from(end == end::REACHED);
            whole[r(whole::COLLISIONS)] += u32::from(end == end::COLLIDED);
            whole[r(whole::TRUNCATIONS)] += u32::from(end == end::TRUNCATED);
            whole[r(whole::LENGTHS)] += age;
        }
    }
}
