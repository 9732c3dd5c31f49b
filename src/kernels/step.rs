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
        /// Steps after which an episode is truncated.
        pub max_steps: u32,
        /// Distance at which the target counts as reached, m.
        pub reach: f32,
        /// Reward on arrival.
        pub bonus: f32,
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
        let at = [real[r(real::X)] + moved[0], real[r(real::Z)] + moved[1]];
        real[r(real::X)] = at[0];
        real[r(real::Z)] = at[1];
        real[r(real::HEADING_X)] = turned[0] / length;
        real[r(real::HEADING_Z)] = turned[1] / length;
        real[r(real::TRAVELLED)] += played.length;
        whole[r(whole::FRAME)] = candidates[matched[env] as usize] + PLAYED as u32;

        let age = whole[r(whole::AGE)] + 1;
        whole[r(whole::AGE)] = age;
        let (dx, dz) = (
            real[r(real::TARGET_X)] - at[0],
            real[r(real::TARGET_Z)] - at[1],
        );
        let distance = (dx * dx + dz * dz).sqrt();
        let reached = distance <= params.reach;
        let end = match reached {
            true => end::REACHED,
            false if age >= params.max_steps => end::TRUNCATED,
            false => end::RUNNING,
        };
        let gained = (-distance).exp() + if reached { params.bonus } else { 0.0 };
        reward[offset + env] = gained;
        ended[offset + env] = end;
        let total = real[r(real::RETURN)] + gained;
        real[r(real::RETURN)] = total;
        if end != end::RUNNING {
            real[r(real::RETURNS)] += total;
            whole[r(whole::EPISODES)] += 1;
            whole[r(whole::SUCCESSES)] += u32::from(reached);
            whole[r(whole::LENGTHS)] += age;
        }
    }
}
