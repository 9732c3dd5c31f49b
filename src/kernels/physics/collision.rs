//! Contacts between the shapes of a world. Shader: `shaders/physics/collision.wgsl`.

use super::make_constraints::CONTACT_DIM;
use super::smooth_dynamics::{POSE_DIM, pose};
use super::strided::{gather, scatter};
use crate::gpu::shader::collision::constants as at;
use crate::gpu::{Buffer, Gpu, groups, shader};
use crate::physics::collision::{DetectedContacts, bounding_radius, detect_contacts};
use crate::physics::model::{Geom, GeomShape, Model};
use crate::physics::pose::Pose;
use glam::Vec3;
use rayon::prelude::*;

crate::shader_params! {
    pub struct Params for collision {
        /// Environments of the batch.
        pub envs: u32,
        /// Contacts an environment has room for.
        pub max_contacts: u32,
    }
}

/// Queues the shader on `gpu`.
///
/// `geoms` is what the function [`geoms`] gives, `tables` the
/// [`model_table`](fn@super::model_table::model_table), `poses` `[bodies * POSE_DIM][envs]`.
/// Written are `contacts` `[max_contacts * CONTACT_DIM][envs]` in the world, `contact_ids`
/// `[max_contacts][envs]`, pair times 8 plus point, and `counts` `[2][envs]`: contacts kept, and
/// those that found no room, the shallowest.
pub fn launch(
    gpu: &Gpu,
    geoms: &Buffer<f32>,
    tables: &Buffer<u32>,
    poses: &Buffer<f32>,
    contacts: &Buffer<f32>,
    contact_ids: &Buffer<u32>,
    counts: &Buffer<u32>,
    params: &Params,
) {
    gpu.launch(
        &shader::COLLISION,
        groups(&shader::COLLISION, params.envs as usize),
        &[geoms, tables, poses, contacts, contact_ids, counts],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(
    model: &Model,
    poses: &[f32],
    contacts: &mut [f32],
    contact_ids: &mut [u32],
    counts: &mut [u32],
    params: &Params,
) {
    let (envs, max_contacts) = (params.envs as usize, params.max_contacts as usize);
    let found: Vec<DetectedContacts> = (0..envs)
        .into_par_iter()
        .map(|env| {
            let mut contacts = DetectedContacts::default();
            detect_contacts(
                model,
                &poses_of(poses, envs, env),
                max_contacts,
                &mut contacts,
            );
            contacts
        })
        .collect();
    for (env, found) in found.iter().enumerate() {
        for (slot, point) in found.points.iter().enumerate() {
            let numbers = [point.position, point.normal, point.tangent].map(|v| v.to_array());
            scatter(
                contacts,
                envs,
                env,
                slot * CONTACT_DIM,
                numbers.as_flattened(),
            );
            scatter(
                contacts,
                envs,
                env,
                slot * CONTACT_DIM + CONTACT_DIM - 1,
                &[point.distance],
            );
        }
        scatter(contact_ids, envs, env, 0, &found.ids);
        scatter(
            counts,
            envs,
            env,
            0,
            &[found.ids.len() as u32, found.overflow],
        );
    }
}

/// The poses of an environment's bodies, out of `[bodies * 7][envs]`.
pub fn poses_of(poses: &[f32], envs: usize, env: usize) -> Vec<Pose> {
    let bodies = poses.len() / POSE_DIM / envs;
    let read = |body| {
        let mut numbers = [0.0; POSE_DIM];
        gather(poses, envs, env, body * POSE_DIM, &mut numbers);
        pose(&numbers)
    };
    (0..bodies).map(read).collect()
}

/// The model's geoms as the shader reads them.
pub fn geoms(model: &Model) -> Vec<f32> {
    model.geoms.iter().flat_map(numbers).collect()
}

fn numbers(geom: &Geom) -> [f32; at::GEOM_DIM as usize] {
    let (kind, size) = match geom.shape {
        GeomShape::Plane => (at::PLANE, Vec3::ZERO),
        GeomShape::Sphere { radius } => (at::SPHERE, Vec3::X * radius),
        GeomShape::Capsule { radius, half } => (at::CAPSULE, Vec3::new(radius, half, 0.0)),
        GeomShape::Box { half } => (at::BOX, half),
    };
    let mut numbers = [0.0; at::GEOM_DIM as usize];
    let mut set = |field: u32, values: &[f32]| {
        numbers[field as usize..][..values.len()].copy_from_slice(values);
    };
    set(at::GEOM_BODY, &[geom.body.map_or(-1.0, |body| body as f32)]);
    set(at::GEOM_KIND, &[kind as f32]);
    set(at::GEOM_SIZE, &size.to_array());
    set(at::GEOM_POSITION, &geom.position.to_array());
    set(at::GEOM_ROTATION, &geom.rotation.to_array());
    set(at::GEOM_BOUNDING_RADIUS, &[bounding_radius(geom.shape)]);
    numbers
}
