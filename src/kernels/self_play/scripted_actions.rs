//! What opponents do that follow a script. Shader: `shaders/self_play/scripted_actions.wgsl`.

use super::SCRIPTED;
use crate::gpu::{Argument, Buffer, Gpu, groups, shader};

crate::shader_params! {
    pub struct Params for scripted_actions {
        /// Environments.
        pub envs: u32,
    }
}

/// How far a body looks ahead that chooses how to move, s.
const AHEAD_S: f32 = 0.5;
/// Weight of facing the place beside a metre of the way there: who goes backwards does not see it.
const FACING: f32 = 2.0;

/// Queues the shader on `gpu`.
///
/// `own` is the learner's row in each environment, `place` what [`group_bouts`](super::group_bouts) says of its
/// opponent. `scripts` are the numbers of an action and of an observation, then of every script where it observes the
/// place to go to, two numbers in its heading frame, m; the first of its strides; and how many it has. `strides` are
/// `[..][2 + action]`: a speed along the heading, m/s, a speed at which the heading turns to the left, rad/s, and the
/// action that leads to them. Of `action`, `[2 envs][action]`, the rows of scripts are written.
pub fn launch(
    gpu: &Gpu,
    own: &Buffer<u32>,
    place: &Buffer<u32>,
    scripts: &Buffer<u32>,
    strides: &Buffer<f32>,
    observation: &Buffer<f32>,
    action: &Buffer<f32>,
    params: &Params,
) {
    let groups = groups(&shader::SCRIPTED_ACTIONS, params.envs as usize);
    let buffers: [&dyn Argument; 6] = [own, place, scripts, strides, observation, action];
    gpu.launch(&shader::SCRIPTED_ACTIONS, groups, &buffers, params);
}

/// The shader's computation on the host.
pub fn twin(
    own: &[u32],
    place: &[u32],
    scripts: &[u32],
    strides: &[f32],
    observation: &[f32],
    action: &mut [f32],
    params: &Params,
) {
    let [width, seen] = [scripts[0], scripts[1]].map(|width| width as usize);
    let rows = own.iter().zip(place).take(params.envs as usize);
    for (&own, &place) in rows.filter(|(_, place)| **place >= SCRIPTED) {
        let script = &scripts[2 + 3 * (place - SCRIPTED) as usize..][..3];
        let [target, first, count] = [0, 1, 2].map(|at| script[at] as usize);
        let row = (own ^ 1) as usize;
        let target = row * seen + target;
        let strides = strides[first * (2 + width)..].chunks_exact(2 + width);
        let speeds = strides.clone().take(count);
        let speeds = speeds.map(|stride| [stride[0], stride[1]]);
        let best = nearest(speeds, [observation[target], observation[target + 1]]);
        if let Some(stride) = strides.clone().nth(best) {
            action[row * width..][..width].copy_from_slice(&stride[2..]);
        }
    }
}

/// The index of the stride, of whose speeds along the heading, m/s, and of the heading to the left, rad/s, by which a
/// body comes nearest to a place in its heading frame, and faces it most, while it goes on so.
pub fn nearest(speeds: impl IntoIterator<Item = [f32; 2]>, [ahead, left]: [f32; 2]) -> usize {
    let bearing = left.atan2(ahead);
    let score = |[forward, turn]: [f32; 2]| {
        let turned = turn * AHEAD_S;
        let nearer = forward * AHEAD_S * (bearing - 0.5 * turned).cos();
        nearer + FACING * (bearing - turned).cos()
    };
    let scores = speeds.into_iter().map(score).enumerate();
    let best = scores.max_by(|a, b| a.1.total_cmp(&b.1));
    best.map_or(0, |(stride, _)| stride)
}
