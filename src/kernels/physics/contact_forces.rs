//! Contact forces on bodies and between them. Shader: `shaders/physics/contact_forces.wgsl`.

use super::make_constraints::CONTACT_DIM;
use super::strided::{gather, scatter};
use crate::gpu::shader::contact_forces::constants as at;
use crate::gpu::{Buffer, Gpu, groups, shader};
use crate::physics::model::Model;
use crate::physics::pgs::along;
use glam::Vec3;

crate::shader_params! {
    pub struct Params for contact_forces {
        /// Environments of the batch.
        pub envs: u32,
        /// Contacts an environment has room for.
        pub max_contacts: u32,
        /// 1 in an action's first step.
        pub first: u32,
        /// Weight of a step in the mean.
        pub weight: f32,
    }
}

/// Counters of an environment.
pub const COUNTERS: usize = at::COUNTERS as usize;
/// Index of the contacts of all steps.
pub const CONTACTS: usize = at::CONTACTS as usize;
/// Index of the most contacts of a step.
pub const PEAK_CONTACTS: usize = at::PEAK_CONTACTS as usize;
/// Index of the contacts that found no room.
pub const OVERFLOW: usize = at::OVERFLOW as usize;
/// Index of the times that an environment diverged and was started anew.
pub const DIVERGED: usize = at::DIVERGED as usize;

/// Queues the shader on `gpu`.
///
/// `tables` is the [`model_table`](fn@super::model_table::model_table), `contacts`
/// `[max_contacts * CONTACT_DIM][envs]`, `contact_ids` `[max_contacts][envs]`, `counts`
/// `[2][envs]`: contacts kept, and those that found no room; `warm_start` as
/// [`solve_and_integrate`](super::solve_and_integrate) leaves it. `force_pairs` holds the number of
/// pairs, then two bodies each. `forces` is `[(bodies + pairs) * 3][envs]`, N in the world: on
/// every body, and by the first of each pair on the second. `counters` is `[COUNTERS][envs]`.
pub fn launch(
    gpu: &Gpu,
    tables: &Buffer<u32>,
    contacts: &Buffer<f32>,
    contact_ids: &Buffer<u32>,
    counts: &Buffer<u32>,
    warm_start: &Buffer<u32>,
    force_pairs: &Buffer<u32>,
    forces: &Buffer<f32>,
    counters: &Buffer<u32>,
    params: &Params,
) {
    gpu.launch(
        &shader::CONTACT_FORCES,
        groups(&shader::CONTACT_FORCES, params.envs as usize),
        &[
            tables,
            contacts,
            contact_ids,
            counts,
            warm_start,
            force_pairs,
            forces,
            counters,
        ],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(
    model: &Model,
    contacts: &[f32],
    contact_ids: &[u32],
    counts: &[u32],
    warm_start: &[u32],
    force_pairs: &[u32],
    forces: &mut [f32],
    counters: &mut [u32],
    params: &Params,
) {
    let (envs, max_contacts) = (params.envs as usize, params.max_contacts as usize);
    let (&count, force_pairs) = force_pairs.split_first().expect("how many");
    let sums = model.bodies.len() + count as usize;
    for env in 0..envs {
        if params.first == 1 {
            scatter(forces, envs, env, 0, &vec![0.0; 3 * sums]);
        }
        for slot in 0..counts[env] as usize {
            let pair = model.pairs[(contact_ids[slot * envs + env] / 8) as usize];
            let [first, second] = pair.map(|geom| &model.geoms[geom]);
            let mut point = [0.0; CONTACT_DIM];
            gather(contacts, envs, env, slot * CONTACT_DIM, &mut point);
            let mut edges = [0; 4];
            gather(warm_start, envs, env, max_contacts + 4 * slot, &mut edges);
            let edges = edges.map(f32::from_bits);
            let (normal, tangent) = (Vec3::from_slice(&point[3..]), Vec3::from_slice(&point[6..]));
            let [n, t, s] = along(first.mixed(second).0, &edges);
            let force = normal * n + tangent * t + normal.cross(tangent) * s;
            let mut add = |entry: usize, force: Vec3| {
                let mut sum = [0.0; 3];
                gather(forces, envs, env, 3 * entry, &mut sum);
                let sum = Vec3::from_array(sum) + force * params.weight;
                scatter(forces, envs, env, 3 * entry, &sum.to_array());
            };
            for (entry, sign) in entries(model, first.body, second.body, force_pairs) {
                add(entry, force * sign);
            }
        }
        let count = counts[env];
        counters[CONTACTS * envs + env] += count;
        let most = &mut counters[PEAK_CONTACTS * envs + env];
        *most = count.max(*most);
        counters[OVERFLOW * envs + env] += counts[envs + env];
    }
}

/// Which sums a force of the first body on the second belongs to, and its sign there: those of bodies
/// come first, then those of pairs.
pub fn entries<'a>(
    model: &Model,
    first: Option<usize>,
    second: Option<usize>,
    force_pairs: &'a [u32],
) -> impl Iterator<Item = (usize, f32)> + 'a {
    let bodies = model.bodies.len();
    let own = second.map(|body| (body, 1.0)).into_iter();
    let own = own.chain(first.map(|body| (body, -1.0)));
    let of = |body: u32, other: Option<usize>| other == Some(body as usize);
    let pairs = force_pairs.chunks_exact(2).enumerate();
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
