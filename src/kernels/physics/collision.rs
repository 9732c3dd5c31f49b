//! Where the shapes of a world touch. Shader: `shaders/body/contact.wgsl`.

use super::smooth_dynamics::{POSE, pose};
use super::strided::{gather, scatter};
use super::make_constraints::TOUCH;
use crate::physics::collision::{Contacts, find, reach};
use crate::physics::model::{Geom, Model, Shape};
use crate::physics::pose::Pose;
use crate::gpu::kernel::groups;
use crate::gpu::shader::collision::constants as at;
use crate::gpu::{Buffer, Gpu, shader};
use glam::Vec3;
use rayon::prelude::*;

crate::shader_params! {
    pub struct Params for collision {
        pub envs: u32,
        /// Contacts an environment has room for.
        pub slots: u32,
    }
}

pub fn launch(
    gpu: &Gpu,
    geoms: &Buffer<f32>,
    tables: &Buffer<u32>,
    poses: &Buffer<f32>,
    touches: &Buffer<f32>,
    keys: &Buffer<u32>,
    counts: &Buffer<u32>,
    params: &Params,
) {
    gpu.launch(
        &shader::COLLISION,
        groups(&shader::COLLISION, params.envs as usize),
        &[geoms, tables, poses, touches, keys, counts],
        params,
    );
}

pub fn twin(
    model: &Model,
    poses: &[f32],
    touches: &mut [f32],
    keys: &mut [u32],
    counts: &mut [u32],
    params: &Params,
) {
    let (envs, slots) = (params.envs as usize, params.slots as usize);
    let found: Vec<Contacts> = (0..envs)
        .into_par_iter()
        .map(|env| {
            let mut contacts = Contacts::default();
            find(model, &world(poses, envs, env), slots, &mut contacts);
            contacts
        })
        .collect();
    for (env, found) in found.iter().enumerate() {
        for (slot, touch) in found.touches.iter().enumerate() {
            let numbers = [touch.place, touch.normal, touch.tangent].map(|v| v.to_array());
            scatter(touches, envs, env, slot * TOUCH, numbers.as_flattened());
            scatter(
                touches,
                envs,
                env,
                slot * TOUCH + TOUCH - 1,
                &[touch.distance],
            );
        }
        scatter(keys, envs, env, 0, &found.keys);
        scatter(
            counts,
            envs,
            env,
            0,
            &[found.keys.len() as u32, found.overflow],
        );
    }
}

/// The poses of an environment's bodies.
fn world(poses: &[f32], envs: usize, env: usize) -> Vec<Pose> {
    let bodies = poses.len() / POSE / envs;
    let read = |body| {
        let mut numbers = [0.0; POSE];
        gather(poses, envs, env, body * POSE, &mut numbers);
        pose(&numbers)
    };
    (0..bodies).map(read).collect()
}

/// The model's geoms as the shader reads them.
pub fn geoms(model: &Model) -> Vec<f32> {
    model.geoms.iter().flat_map(numbers).collect()
}

fn numbers(geom: &Geom) -> [f32; at::GEOM as usize] {
    let (kind, size) = match geom.shape {
        Shape::Plane => (at::PLANE, Vec3::ZERO),
        Shape::Sphere { radius } => (at::SPHERE, Vec3::X * radius),
        Shape::Capsule { radius, half } => (at::CAPSULE, Vec3::new(radius, half, 0.0)),
        Shape::Box { half } => (at::BOX, half),
    };
    let mut numbers = [0.0; at::GEOM as usize];
    let mut set = |field: u32, values: &[f32]| {
        numbers[field as usize..][..values.len()].copy_from_slice(values);
    };
    set(at::GEOM_BODY, &[geom.body.map_or(-1.0, |body| body as f32)]);
    set(at::GEOM_KIND, &[kind as f32]);
    set(at::GEOM_SIZE, &size.to_array());
    set(at::GEOM_PLACE, &geom.place.to_array());
    set(at::GEOM_TURN, &geom.turn.to_array());
    set(at::GEOM_REACH, &[reach(geom.shape)]);
    numbers
}
