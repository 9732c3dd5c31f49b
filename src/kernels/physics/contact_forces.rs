//! Contact forces on bodies and between them. Shader: `shaders/body/blows.wgsl`.

use super::strided::{gather, scatter};
use super::make_constraints::TOUCH;
use crate::physics::model::Model;
use crate::physics::pgs::along;
use crate::gpu::kernel::groups;
use crate::gpu::shader::contact_forces::constants as at;
use crate::gpu::{Buffer, Gpu, shader};
use glam::Vec3;

crate::shader_params! {
    pub struct Params for contact_forces {
        pub envs: u32,
        /// Contacts an environment has room for.
        pub slots: u32,
        /// 1 in an action's first step.
        pub first: u32,
        /// Of a step in the mean.
        pub share: f32,
    }
}

/// Numbers of [`tallies`](twin) of an environment, and their places.
pub const TALLIES: usize = at::TALLIES as usize;
pub const CONTACTS: usize = at::CONTACTS as usize;
pub const MOST_CONTACTS: usize = at::MOST_CONTACTS as usize;
pub const OVERFLOW: usize = at::OVERFLOW as usize;
pub const BROKEN: usize = at::BROKEN as usize;

#[allow(clippy::too_many_arguments)]
pub fn launch(
    gpu: &Gpu,
    tables: &Buffer<u32>,
    touches: &Buffer<f32>,
    keys: &Buffer<u32>,
    counts: &Buffer<u32>,
    warm: &Buffer<u32>,
    watched: &Buffer<u32>,
    forces: &Buffer<f32>,
    tallies: &Buffer<u32>,
    params: &Params,
) {
    gpu.launch(
        &shader::CONTACT_FORCES,
        groups(&shader::CONTACT_FORCES, params.envs as usize),
        &[
            tables, touches, keys, counts, warm, watched, forces, tallies,
        ],
        params,
    );
}

#[allow(clippy::too_many_arguments)]
pub fn twin(
    model: &Model,
    touches: &[f32],
    keys: &[u32],
    counts: &[u32],
    warm: &[u32],
    watched: &[u32],
    forces: &mut [f32],
    tallies: &mut [u32],
    params: &Params,
) {
    let (envs, slots) = (params.envs as usize, params.slots as usize);
    let (&count, watched) = watched.split_first().expect("how many");
    let entries = model.bodies.len() + count as usize;
    for env in 0..envs {
        if params.first == 1 {
            scatter(forces, envs, env, 0, &vec![0.0; 3 * entries]);
        }
        for slot in 0..counts[env] as usize {
            let pair = model.pairs[(keys[slot * envs + env] / 8) as usize];
            let [first, second] = pair.map(|geom| &model.geoms[geom]);
            let mut touch = [0.0; TOUCH];
            gather(touches, envs, env, slot * TOUCH, &mut touch);
            let mut edges = [0; 4];
            gather(warm, envs, env, slots + 4 * slot, &mut edges);
            let edges = edges.map(f32::from_bits);
            let (normal, tangent) = (Vec3::from_slice(&touch[3..]), Vec3::from_slice(&touch[6..]));
            let [n, t, s] = along(first.mixed(second).0, &edges);
            let force = normal * n + tangent * t + normal.cross(tangent) * s;
            let mut add = |entry: usize, force: Vec3| {
                let mut sum = [0.0; 3];
                gather(forces, envs, env, 3 * entry, &mut sum);
                let sum = Vec3::from_array(sum) + force * params.share;
                scatter(forces, envs, env, 3 * entry, &sum.to_array());
            };
            for (entry, sign) in shares(model, first.body, second.body, watched) {
                add(entry, force * sign);
            }
        }
        let count = counts[env];
        tallies[CONTACTS * envs + env] += count;
        let most = &mut tallies[MOST_CONTACTS * envs + env];
        *most = count.max(*most);
        tallies[OVERFLOW * envs + env] += counts[envs + env];
    }
}

/// Which sums a force of the first body on the second belongs to, and its sign there: bodies first, then
/// watched pairs.
pub fn shares<'a>(
    model: &Model,
    first: Option<usize>,
    second: Option<usize>,
    watched: &'a [u32],
) -> impl Iterator<Item = (usize, f32)> + 'a {
    let bodies = model.bodies.len();
    let own = second.map(|body| (body, 1.0)).into_iter();
    let own = own.chain(first.map(|body| (body, -1.0)));
    let of = |body: u32, other: Option<usize>| other == Some(body as usize);
    let pairs = watched.chunks_exact(2).enumerate();
    own.chain(pairs.filter_map(move |(index, pair)| {
        if of(pair[0], first) && of(pair[1], second) {
            Some((bodies + index, 1.0))
        } else if of(pair[0], second) && of(pair[1], first) {
            Some((bodies + index, -1.0))
        } else {
            None
        }
    }))
}
