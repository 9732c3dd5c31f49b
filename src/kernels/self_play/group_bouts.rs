//! Rows of policies, in blocks that belong to one policy. Shader: `shaders/self_play/group_bouts.wgsl`.

use super::{NOBODY, OpponentTable, SCRIPTED};
use crate::gpu::shader::group_bouts::constants as wgsl;
use crate::gpu::{Argument, Buffer, Gpu, shader};

crate::shader_params! {
    pub struct Params for group_bouts {
        /// Rows of a block.
        pub block: u32,
        /// Blocks that there are.
        pub blocks: u32,
    }
}

/// The most policies.
pub const MAX_POLICIES: usize = wgsl::MAX_POLICIES as usize;

/// Blocks of so many rows that suffice for `envs` environments, whoever meets which of the `policies`.
pub fn blocks(envs: usize, policies: usize, block: usize) -> usize {
    envs.div_ceil(block) + policies
}

/// Queues the shader on `gpu`.
///
/// `opponents` are those of an [`OpponentTable`], `opponent` is the number of each environment's. `place`, `[envs]`, takes
/// the row of a policy that plays there, or a script's index and [`SCRIPTED`]; `slots`, `[blocks][block]`, the
/// environment of each of these rows, or [`NOBODY`]; `blocks` the policy of each block, from 0, or [`NOBODY`].
pub fn launch(
    gpu: &Gpu,
    opponents: &Buffer<u32>,
    opponent: &Buffer<u32>,
    place: &Buffer<u32>,
    slots: &Buffer<u32>,
    blocks: &Buffer<u32>,
    params: &Params,
) {
    let buffers: [&dyn Argument; 5] = [opponents, opponent, place, slots, blocks];
    gpu.launch(&shader::GROUP_BOUTS, [1; 3], &buffers, params);
}

/// The shader's computation on the host.
pub fn twin(
    opponents: &OpponentTable,
    opponent: &[u32],
    place: &mut [u32],
    slots: &mut [u32],
    blocks: &mut [u32],
    params: &Params,
) {
    let block = params.block as usize;
    let mut rows: Vec<Vec<u32>> = vec![Vec::new(); opponents.policies()];
    for (env, (place, &number)) in place.iter_mut().zip(opponent).enumerate() {
        let index = opponents.index(number);
        *place = SCRIPTED + index as u32;
        if let Some(policy) = index.checked_sub(opponents.scripted) {
            rows[policy].push(env as u32);
        }
    }
    let blocks = &mut blocks[..params.blocks as usize];
    blocks.fill(NOBODY);
    slots[..blocks.len() * block].fill(NOBODY);
    let mut first = 0;
    for (policy, envs) in rows.iter().enumerate() {
        for (slot, &env) in (first * block..).zip(envs) {
            slots[slot] = env;
            place[env as usize] = slot as u32;
            blocks[slot / block] = policy as u32;
        }
        first += envs.len().div_ceil(block);
    }
}
