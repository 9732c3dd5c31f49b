//! All environments of a training by motion matching at once, drawn from where the training keeps them.

use super::crowd_shape::{CrowdParams, CrowdShape};
use super::painter::{Drawable, Pass};
use super::renderer::Renderer;
use crate::env::live_view::{LocomotionView, States};
use crate::env::locomotion::LocomotionTask;
use crate::gpu::Shared;
use crate::gpu::shader::{DRAW_CROWD, DRAW_CROWD_CUBOIDS};
use crate::motion::database::Database;
use crate::playback::PlacedFrame;
use crate::playback::capsule_rig::CapsuleRig;
use glam::Vec3;
use rayon::prelude::*;
use wgpu::util::{BufferInitDescriptor, DeviceExt};

/// Between two environments' origins on the plane, and between two squares of obstacles, m.
const SPACING: f32 = 4.0;
/// Farthest of a body's points from its origin, m; as in the shader.
const REACH: f32 = 4.0;

/// A state on the host and its copies on the device.
struct Copied {
    states: States,
    state_f32: wgpu::Buffer,
    state_u32: wgpu::Buffer,
    boxes: Option<wgpu::Buffer>,
}

/// The characters of a training by motion matching, ready to be drawn.
pub struct Crowd {
    /// The characters with their targets; then the obstacles, if there are any.
    shapes: Vec<CrowdShape>,
    /// Side of the square they fill, m.
    pub side: f32,
    copied: Option<Copied>,
    /// Keeps the buffers that are drawn from.
    _live_view: LocomotionView,
}

impl Crowd {
    /// The crowd of `envs` environments of a task, on the renderer's device.
    pub fn new(
        renderer: &Renderer,
        database: &Database,
        live_view: LocomotionView,
        task: &LocomotionTask,
        envs: usize,
    ) -> Crowd {
        let device = &renderer.device;
        let rig = CapsuleRig::of(&database.skeleton, &database.roles);
        let columns = (envs as f32).sqrt().ceil() as u32;
        let params = CrowdParams {
            envs: envs as u32,
            bones: rig.bones.len() as u32,
            points: rig.points().len() as u32,
            columns,
            count: task.obstacles() as u32,
            spacing: match task {
                LocomotionTask::Plane(_) => SPACING,
                LocomotionTask::Obstacles(task) => 2.0 * task.arena_half_extent + SPACING,
            },
            unused: [0; 2],
        };
        let storage = |contents: &[u8], usage| {
            device.create_buffer_init(&BufferInitDescriptor {
                label: Some("crowd"),
                contents,
                usage,
            })
        };
        let read = wgpu::BufferUsages::STORAGE;
        let points = storage(bytemuck::cast_slice(&points(database, &rig)), read);
        let bones = storage(bytemuck::cast_slice(&rig.table()), read);
        let uniform = storage(bytemuck::bytes_of(&params), wgpu::BufferUsages::UNIFORM);
        let uniform = uniform.as_entire_binding();
        let copied = copied(&live_view, |bytes| {
            storage(bytes, read | wgpu::BufferUsages::COPY_DST)
        });
        let (state_f32, state_u32, boxes) = match (&live_view, &copied) {
            (LocomotionView::Gpu(buffers), _) => (
                buffers.state_f32.binding(),
                buffers.state_u32.binding(),
                buffers.boxes.as_ref().map(Shared::binding),
            ),
            (_, Some(copied)) => (
                copied.state_f32.as_entire_binding(),
                copied.state_u32.as_entire_binding(),
                copied.boxes.as_ref().map(wgpu::Buffer::as_entire_binding),
            ),
            (LocomotionView::Cpu(_), None) => unreachable!("a state on the host is always copied"),
        };
        let (points, bones) = (points.as_entire_binding(), bones.as_entire_binding());
        let mut shapes = vec![CrowdShape::capsules(
            renderer,
            DRAW_CROWD,
            vec![state_f32, state_u32, points, bones, uniform.clone()],
            params.envs * (params.bones + 1),
        )];
        if let Some(boxes) = boxes {
            shapes.push(CrowdShape::cuboids(
                renderer,
                DRAW_CROWD_CUBOIDS,
                vec![boxes, uniform],
                params.envs * params.count,
            ));
        }
        Crowd {
            shapes,
            side: columns as f32 * params.spacing,
            copied,
            _live_view: live_view,
        }
    }
}

impl Drawable for Crowd {
    /// Takes over the latest state, if it is kept on the host.
    fn refresh(&self, queue: &wgpu::Queue) {
        if let Some(copied) = &self.copied {
            let state = copied.states.now();
            queue.write_buffer(&copied.state_f32, 0, bytemuck::cast_slice(&state.state_f32));
            queue.write_buffer(&copied.state_u32, 0, bytemuck::cast_slice(&state.state_u32));
            if let Some(boxes) = &copied.boxes {
                queue.write_buffer(boxes, 0, bytemuck::cast_slice(&state.boxes));
            }
        }
    }

    fn draw(&self, pass: &mut wgpu::RenderPass, which: Pass) {
        self.shapes.iter().for_each(|shape| shape.draw(pass, which));
    }
}

fn copied(live_view: &LocomotionView, buffer: impl Fn(&[u8]) -> wgpu::Buffer) -> Option<Copied> {
    let LocomotionView::Cpu(states) = live_view else {
        return None;
    };
    let now = states.now();
    let boxes = bytemuck::cast_slice(&now.boxes);
    Some(Copied {
        state_f32: buffer(bytemuck::cast_slice(&now.state_f32)),
        state_u32: buffer(bytemuck::cast_slice(&now.state_u32)),
        boxes: (!boxes.is_empty()).then(|| buffer(boxes)),
        states: states.clone(),
    })
}

/// `[frames][points][2]`: x and y, z and 0 in the character frame, packed.
fn points(database: &Database, rig: &CapsuleRig) -> Vec<[u32; 2]> {
    let spots = rig.points();
    let pair = |x: f32, y: f32| u32::from(quantise(x)) | u32::from(quantise(y)) << 16;
    let frame = |frame| {
        let shown = PlacedFrame {
            frame,
            at: [0.0; 2],
            heading: [0.0, 1.0],
        };
        let (positions, rotations) = shown.pose(database).world(&database.skeleton);
        let position =
            |&(joint, offset): &(usize, Vec3)| positions[joint] + rotations[joint] * offset;
        let points: Vec<Vec3> = spots.iter().map(position).collect();
        points.into_iter().map(|p| [pair(p.x, p.y), pair(p.z, 0.0)])
    };
    (0..database.frames())
        .into_par_iter()
        .flat_map_iter(frame)
        .collect()
}

/// A length from `-REACH` to `REACH` as 16 bits: exact to a tenth of a millimetre.
fn quantise(metres: f32) -> u16 {
    let most = f32::from(i16::MAX);
    (metres / REACH * most).round().clamp(-most, most) as i16 as u16
}
