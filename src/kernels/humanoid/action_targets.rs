//! Targets of the drives from actions. Shader: `shaders/humanoid/action_targets.wgsl`.

use crate::gpu::{Buffer, Gpu, groups, shader};
use crate::kernels::physics::strided::scatter;

crate::shader_params! {
    pub struct Params for action_targets {
        /// Environments of the batch.
        pub envs: u32,
        /// Drives of an environment.
        pub driven: u32,
        /// Index of the first action.
        pub at: u32,
    }
}

/// Queues the shader on `gpu`.
///
/// `action` holds `[envs][driven]` from `params.at` on, `scale` is `[2][driven]`, `targets`
/// `[driven][envs]`.
pub fn launch(
    gpu: &Gpu,
    action: &Buffer<f32>,
    scale: &Buffer<f32>,
    targets: &Buffer<f32>,
    params: &Params,
) {
    let [across, ..] = groups(&shader::ACTION_TARGETS, params.envs as usize);
    let groups = [across, params.driven, 1];
    let buffers: [&dyn crate::gpu::Argument; 3] = [action, scale, targets];
    gpu.launch(&shader::ACTION_TARGETS, groups, &buffers, params);
}

/// The shader's computation on the host.
pub fn twin(action: &[f32], scale: &[f32], targets: &mut [f32], params: &Params) {
    let (envs, driven) = (params.envs as usize, params.driven as usize);
    let mut own = vec![0.0; driven];
    for env in 0..envs {
        let action = &action[params.at as usize + env * driven..][..driven];
        set_targets(action, scale, &mut own);
        scatter(targets, envs, env, 0, &own);
    }
}

/// Targets `[driven]` of an environment's action `[driven]`, rad. Actions beyond one count as one.
#[expect(clippy::manual_clamp, reason = "NaN becomes a number here")]
pub fn set_targets(action: &[f32], scale: &[f32], targets: &mut [f32]) {
    let (offset, scale) = scale.split_at(targets.len());
    for (drive, target) in targets.iter_mut().enumerate() {
        let within = action[drive].max(-1.0).min(1.0);
        *target = offset[drive] + scale[drive] * within;
    }
}
