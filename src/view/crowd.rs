//! All environments of a training at once, drawn from where the training keeps them.

use super::body::Body;
use super::painter::{Mesh, Pass, Pipelines};
use super::renderer::{Renderer, sphere, vertex_buffer};
use crate::gpu::shader::DRAW_CROWD;
use crate::motion::database::Database;
use crate::playback::Shown;
use crate::world::watched::{State, Watched};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use rayon::prelude::*;
use std::sync::{Arc, Mutex, PoisonError};
use wgpu::util::{BufferInitDescriptor, DeviceExt};

/// Between two environments' origins, m.
const SPACING: f32 = 4.0;
/// Farthest of a body's points from its origin, m; as in the shader.
const REACH: f32 = 4.0;

/// `Crowd` of `shaders/view/crowd.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Params {
    envs: u32,
    bones: u32,
    points: u32,
    columns: u32,
    spacing: f32,
    unused: [u32; 3],
}

/// A state on the host and its copies on the device.
struct Copied {
    state: Arc<Mutex<State>>,
    real: wgpu::Buffer,
    whole: wgpu::Buffer,
}

pub struct Crowd {
    pipelines: Pipelines,
    mesh: Mesh,
    group: wgpu::BindGroup,
    instances: u32,
    /// Side of the square they stand on, m.
    pub side: f32,
    copied: Option<Copied>,
    /// Keeps the buffers that are drawn from.
    _watched: Watched,
}

impl Crowd {
    /// Of a batch of `envs` worlds, on the renderer's device.
    pub fn new(renderer: &Renderer, database: &Database, watched: Watched, envs: usize) -> Crowd {
        let device = &renderer.device;
        let body = Body::of(&database.skeleton, &database.roles);
        let columns = (envs as f32).sqrt().ceil() as u32;
        let params = Params {
            envs: envs as u32,
            bones: body.bones.len() as u32,
            points: body.points().len() as u32,
            columns,
            spacing: SPACING,
            unused: [0; 3],
        };
        let storage = |contents: &[u8], usage| {
            device.create_buffer_init(&BufferInitDescriptor {
                label: Some("crowd"),
                contents,
                usage,
            })
        };
        let read = wgpu::BufferUsages::STORAGE;
        let points = storage(bytemuck::cast_slice(&points(database, &body)), read);
        let bones = storage(bytemuck::cast_slice(&body.table()), read);
        let uniform = storage(bytemuck::bytes_of(&params), wgpu::BufferUsages::UNIFORM);
        let copied = copied(&watched, |bytes| {
            storage(bytes, read | wgpu::BufferUsages::COPY_DST)
        });
        let layout = layout(device);
        let (real, whole) = match (&watched, &copied) {
            (Watched::Gpu(buffers), _) => (buffers.real.binding(), buffers.whole.binding()),
            (_, Some(copied)) => (
                copied.real.as_entire_binding(),
                copied.whole.as_entire_binding(),
            ),
            (Watched::Cpu(_), None) => unreachable!("a state on the host is always copied"),
        };
        let bound = [
            real,
            whole,
            points.as_entire_binding(),
            bones.as_entire_binding(),
            uniform.as_entire_binding(),
        ];
        let entries: Vec<_> = (0..)
            .zip(bound)
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
            .collect();
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("crowd"),
            layout: &layout,
            entries: &entries,
        });
        let corner = wgpu::vertex_attr_array![0 => Float32x4];
        let buffers = [vertex_buffer::<[f32; 4]>(
            wgpu::VertexStepMode::Vertex,
            &corner,
        )];
        Crowd {
            pipelines: renderer.pipelines(DRAW_CROWD, &buffers, Some(&layout)),
            mesh: Mesh::new(device, &sphere(8, 2)),
            group,
            instances: params.envs * (params.bones + 1),
            side: columns as f32 * SPACING,
            copied,
            _watched: watched,
        }
    }

    /// Takes over the latest state, if it is kept on the host.
    pub fn refresh(&self, queue: &wgpu::Queue) {
        if let Some(copied) = &self.copied {
            let state = copied.state.lock().unwrap_or_else(PoisonError::into_inner);
            queue.write_buffer(&copied.real, 0, bytemuck::cast_slice(&state.real));
            queue.write_buffer(&copied.whole, 0, bytemuck::cast_slice(&state.whole));
        }
    }

    pub fn draw(&self, pass: &mut wgpu::RenderPass, which: Pass) {
        pass.set_pipeline(self.pipelines.of(which));
        pass.set_bind_group(2, &self.group, &[]);
        self.mesh.draw(pass, self.instances);
    }
}

fn copied(watched: &Watched, buffer: impl Fn(&[u8]) -> wgpu::Buffer) -> Option<Copied> {
    let Watched::Cpu(state) = watched else {
        return None;
    };
    let now = state.lock().unwrap_or_else(PoisonError::into_inner);
    Some(Copied {
        real: buffer(bytemuck::cast_slice(&now.real)),
        whole: buffer(bytemuck::cast_slice(&now.whole)),
        state: state.clone(),
    })
}

/// `[frames][points][2]`: x and y, z and 0 in the character frame, packed.
fn points(database: &Database, body: &Body) -> Vec<[u32; 2]> {
    let spots = body.points();
    let pair = |x: f32, y: f32| u32::from(share(x)) | u32::from(share(y)) << 16;
    let frame = |frame| {
        let shown = Shown {
            frame,
            at: [0.0; 2],
            heading: [0.0, 1.0],
        };
        let (positions, rotations) = shown.pose(database).world(&database.skeleton);
        let place = |&(joint, offset): &(usize, Vec3)| positions[joint] + rotations[joint] * offset;
        let places: Vec<Vec3> = spots.iter().map(place).collect();
        places.into_iter().map(|p| [pair(p.x, p.y), pair(p.z, 0.0)])
    };
    (0..database.frames())
        .into_par_iter()
        .flat_map_iter(frame)
        .collect()
}

/// A length from `-REACH` to `REACH` as 16 bits: exact to a tenth of a millimetre.
fn share(metres: f32) -> u16 {
    let most = f32::from(i16::MAX);
    (metres / REACH * most).round().clamp(-most, most) as i16 as u16
}

fn layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let entry = |binding| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::VERTEX,
        ty: wgpu::BindingType::Buffer {
            ty: match binding {
                4 => wgpu::BufferBindingType::Uniform,
                _ => wgpu::BufferBindingType::Storage { read_only: true },
            },
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    };
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("crowd"),
        entries: &[0, 1, 2, 3, 4].map(entry),
    })
}
