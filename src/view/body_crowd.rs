//! The simulated bodies of all environments of a training at once, drawn from where the training keeps
//! them.

use super::crowd_shape::{CrowdParams, CrowdShape};
use super::painter::{Drawable, Pass};
use super::renderer::Renderer;
use super::shapes::{self, Look};
use crate::env::body_view::{BodyStates, BodyView, BodyWorlds};
use crate::gpu::shader::{DRAW_CROWD_BODY_CAPSULES, DRAW_CROWD_BODY_CUBOIDS};
use crate::kernels::physics::smooth_dynamics::{POSE_DIM, numbers};
use crate::kernels::physics::strided::scatter;
use crate::physics::model::{GeomShape, Model};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use std::sync::{Arc, Mutex};
use wgpu::util::{BufferInitDescriptor, DeviceExt};

/// Between two environments, m; where there is something to go to, more.
const SPACING: [f32; 2] = [4.0, 8.0];

/// `BodyCapsule` of `shaders/view/crowd_body_capsules.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct BodyCapsule {
    a: [f32; 4],
    b: [f32; 4],
    colour: [f32; 3],
    body: u32,
}

/// `BodyCuboid` of `shaders/view/crowd_body_cuboids.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct BodyCuboid {
    centre: [f32; 3],
    body: u32,
    half: [f32; 4],
    rotation: [f32; 4],
    colour: [f32; 4],
}

/// Worlds on the host, and their copies on the device.
struct CopiedWorlds {
    model: Arc<Model>,
    parts: Vec<Arc<Mutex<BodyStates>>>,
    poses: wgpu::Buffer,
    starts: wgpu::Buffer,
}

/// The bodies of a training, ready to be drawn.
pub struct BodyCrowd {
    /// Capsules, then boxes, if there are any.
    shapes: Vec<CrowdShape>,
    /// Side of the square they begin in, m.
    pub side: f32,
    copied: Option<CopiedWorlds>,
    /// Keeps the buffers that are drawn from.
    _view: BodyView,
}

impl BodyCrowd {
    /// The crowd of a training's environments, on the renderer's device.
    pub fn new(renderer: &Renderer, view: BodyView) -> BodyCrowd {
        let device = &renderer.device;
        let (capsules, cuboids) = tables(&view.model);
        let copied = CopiedWorlds::new(device, &view);
        let (envs, poses, starts) = match (&view.worlds, &copied) {
            (BodyWorlds::Gpu(worlds), _) => {
                (worlds.envs, worlds.poses.binding(), worlds.starts.binding())
            }
            (BodyWorlds::Cpu(parts), Some(copied)) => (
                BodyStates::joined(parts).starts.len(),
                copied.poses.as_entire_binding(),
                copied.starts.as_entire_binding(),
            ),
            (BodyWorlds::Cpu(_), None) => unreachable!("worlds on the host are always copied"),
        };
        let columns = (envs as f32).sqrt().ceil() as u32;
        let params = CrowdParams {
            envs: envs as u32,
            bones: capsules.len() as u32,
            points: 0,
            columns,
            count: cuboids.len() as u32,
            spacing: SPACING[usize::from(view.model.trees.len() > 1)],
            unused: [0; 2],
        };
        let buffer = |contents: &[u8], usage| {
            device.create_buffer_init(&BufferInitDescriptor {
                label: Some("crowd"),
                contents,
                usage,
            })
        };
        let uniform = buffer(bytemuck::bytes_of(&params), wgpu::BufferUsages::UNIFORM);
        let storage = wgpu::BufferUsages::STORAGE;
        let mut shapes = Vec::new();
        if !capsules.is_empty() {
            let table = buffer(bytemuck::cast_slice(&capsules), storage);
            let (text, count) = (DRAW_CROWD_BODY_CAPSULES, params.envs * params.bones);
            let bound = bound([&poses, &starts], [&table, &uniform]);
            shapes.push(CrowdShape::capsules(renderer, text, bound, count));
        }
        if !cuboids.is_empty() {
            let table = buffer(bytemuck::cast_slice(&cuboids), storage);
            let (text, count) = (DRAW_CROWD_BODY_CUBOIDS, params.envs * params.count);
            let bound = bound([&poses, &starts], [&table, &uniform]);
            shapes.push(CrowdShape::cuboids(renderer, text, bound, count));
        }
        BodyCrowd {
            shapes,
            side: columns as f32 * params.spacing,
            copied,
            _view: view,
        }
    }
}

impl Drawable for BodyCrowd {
    /// Takes over the latest step, if it is kept on the host.
    fn refresh(&self, queue: &wgpu::Queue) {
        if let Some(copied) = &self.copied {
            let (poses, starts) = flat(&copied.model, &BodyStates::joined(&copied.parts));
            queue.write_buffer(&copied.poses, 0, bytemuck::cast_slice(&poses));
            queue.write_buffer(&copied.starts, 0, bytemuck::cast_slice(&starts));
        }
    }

    fn draw(&self, pass: &mut wgpu::RenderPass, which: Pass) {
        self.shapes.iter().for_each(|shape| shape.draw(pass, which));
    }
}

impl CopiedWorlds {
    /// Nothing of worlds that are on the device.
    fn new(device: &wgpu::Device, view: &BodyView) -> Option<CopiedWorlds> {
        let BodyWorlds::Cpu(parts) = &view.worlds else {
            return None;
        };
        let (poses, starts) = flat(&view.model, &BodyStates::joined(parts));
        let buffer = |numbers: &[f32]| {
            device.create_buffer_init(&BufferInitDescriptor {
                label: Some("crowd"),
                contents: bytemuck::cast_slice(numbers),
                usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
            })
        };
        Some(CopiedWorlds {
            model: view.model.clone(),
            parts: parts.clone(),
            poses: buffer(&poses),
            starts: buffer(&starts),
        })
    }
}

/// What a shader binds: poses and starts, then a table of shapes and the crowd.
fn bound<'a>(
    worlds: [&wgpu::BindingResource<'a>; 2],
    own: [&'a wgpu::Buffer; 2],
) -> Vec<wgpu::BindingResource<'a>> {
    let own = own.map(wgpu::Buffer::as_entire_binding);
    worlds.into_iter().cloned().chain(own).collect()
}

/// Poses `[bodies * POSE_DIM][envs]` and starts `[2][envs]`, as a GPU has them.
fn flat(model: &Model, states: &BodyStates) -> (Vec<f32>, Vec<f32>) {
    let envs = states.starts.len();
    let mut poses = vec![0.0; POSE_DIM * model.bodies.len() * envs];
    for (env, q) in states.q.chunks_exact(model.nq()).enumerate() {
        for (body, pose) in shapes::poses(model, q).iter().enumerate() {
            scatter(&mut poses, envs, env, POSE_DIM * body, &numbers(pose));
        }
    }
    let starts = [0, 1].map(|axis| states.starts.iter().map(move |start| start[axis]));
    (poses, starts.into_iter().flatten().collect())
}

/// The shapes of a model's bodies; what stands still is left out.
fn tables(model: &Model) -> (Vec<BodyCapsule>, Vec<BodyCuboid>) {
    let (mut capsules, mut cuboids) = (Vec::new(), Vec::new());
    for geom in &model.geoms {
        let Some(body) = geom.body.map(|body| body as u32) else {
            continue;
        };
        let colour = shapes::colour(model, geom, Look::Solid);
        let mut capsule = |radius: f32, half: f32| {
            let end = |along: f32| geom.position + geom.rotation * (Vec3::Z * along);
            capsules.push(BodyCapsule {
                a: end(-half).extend(radius).to_array(),
                b: end(half).extend(radius).to_array(),
                colour,
                body,
            });
        };
        match geom.shape {
            GeomShape::Plane => {}
            GeomShape::Sphere { radius } => capsule(radius, 0.0),
            GeomShape::Capsule { radius, half } => capsule(radius, half),
            GeomShape::Box { half } => cuboids.push(BodyCuboid {
                centre: geom.position.to_array(),
                body,
                half: half.extend(0.0).to_array(),
                rotation: geom.rotation.to_array(),
                colour: Vec3::from(colour).extend(0.0).to_array(),
            }),
        }
    }
    (capsules, cuboids)
}
