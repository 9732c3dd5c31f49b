//! One kind of shape: its pipelines and the instances to draw.

use super::render_target::{COLOUR, DEPTH, SAMPLES};
use bytemuck::Pod;
use std::num::NonZeroU64;
use wgpu::util::{BufferInitDescriptor, DeviceExt};

/// Something that draws itself in both passes, beside a scene.
pub trait Drawable {
    /// Takes over what has changed since the last picture.
    fn refresh(&self, queue: &wgpu::Queue);

    /// Records its draw calls in a pass.
    fn draw(&self, pass: &mut wgpu::RenderPass, which: Pass);
}

/// A mesh on the device, drawn once an instance.
pub struct Mesh {
    corners: wgpu::Buffer,
    count: u32,
}

impl Mesh {
    /// Copies the corners of triangles to the device.
    pub fn new<T: Pod>(device: &wgpu::Device, corners: &[T]) -> Mesh {
        Mesh {
            corners: device.create_buffer_init(&BufferInitDescriptor {
                label: Some("mesh"),
                contents: bytemuck::cast_slice(corners),
                usage: wgpu::BufferUsages::VERTEX,
            }),
            count: corners.len() as u32,
        }
    }

    /// Draws so many instances.
    pub fn draw(&self, pass: &mut wgpu::RenderPass, instances: u32) {
        pass.set_vertex_buffer(0, self.corners.slice(..));
        pass.draw(0..self.count, 0..instances);
    }
}

/// The render pipelines of a shape, one a pass.
pub struct Pipelines {
    cast: wgpu::RenderPipeline,
    paint: wgpu::RenderPipeline,
}

/// Layouts of the bind groups: those of a pass, and a shape's own.
pub struct Layouts<'a> {
    /// Group 0: the view.
    pub view: &'a wgpu::BindGroupLayout,
    /// Group 1: the shadow map.
    pub shadows: &'a wgpu::BindGroupLayout,
    /// Group 2, if a shape has one.
    pub own: Option<&'a wgpu::BindGroupLayout>,
}

/// A pass over the scene.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Pass {
    /// Depths as the sun sees them.
    Cast,
    /// Colours as the camera sees them.
    Paint,
}

impl Pipelines {
    /// From the text of a shader under `shaders/view`.
    pub fn new(
        device: &wgpu::Device,
        text: &str,
        buffers: &[Option<wgpu::VertexBufferLayout>],
        layouts: &Layouts,
    ) -> Pipelines {
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: None,
            source: wgpu::ShaderSource::Wgsl(text.into()),
        });
        let pipeline = |pass: Pass| {
            // While shadows are drawn, they cannot be looked at.
            let shadows = (pass == Pass::Paint).then_some(layouts.shadows);
            let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: None,
                bind_group_layouts: &[Some(layouts.view), shadows, layouts.own],
                immediate_size: 0,
            });
            let (samples, bias) = match pass {
                Pass::Cast => (1, 2),
                Pass::Paint => (SAMPLES, 0),
            };
            let targets = [Some(COLOUR.into())];
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: None,
                layout: Some(&layout),
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some("place"),
                    compilation_options: Default::default(),
                    buffers,
                },
                primitive: wgpu::PrimitiveState {
                    topology: match buffers.is_empty() {
                        true => wgpu::PrimitiveTopology::TriangleStrip,
                        false => wgpu::PrimitiveTopology::TriangleList,
                    },
                    ..Default::default()
                },
                depth_stencil: Some(wgpu::DepthStencilState {
                    format: DEPTH,
                    depth_write_enabled: Some(true),
                    depth_compare: Some(wgpu::CompareFunction::Less),
                    stencil: Default::default(),
                    bias: wgpu::DepthBiasState {
                        constant: bias,
                        slope_scale: bias as f32,
                        clamp: 0.0,
                    },
                }),
                multisample: wgpu::MultisampleState {
                    count: samples,
                    ..Default::default()
                },
                fragment: (pass == Pass::Paint).then_some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some("paint"),
                    compilation_options: Default::default(),
                    targets: &targets,
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        Pipelines {
            cast: pipeline(Pass::Cast),
            paint: pipeline(Pass::Paint),
        }
    }

    /// The pipeline of a pass.
    pub fn of(&self, pass: Pass) -> &wgpu::RenderPipeline {
        match pass {
            Pass::Cast => &self.cast,
            Pass::Paint => &self.paint,
        }
    }
}

/// A shape whose instances are plain data.
pub struct Painter {
    pipelines: Pipelines,
    mesh: Mesh,
    /// Grows, never shrinks.
    instances: wgpu::Buffer,
    count: u32,
}

impl Painter {
    /// A shape without instances so far.
    pub fn new(device: &wgpu::Device, pipelines: Pipelines, mesh: Mesh) -> Painter {
        Painter {
            pipelines,
            mesh,
            instances: vertices(device, 1 << 14),
            count: 0,
        }
    }

    /// Takes the instances to draw next.
    pub fn set<T: Pod>(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, instances: &[T]) {
        let bytes = bytemuck::cast_slice(instances);
        if self.instances.size() < bytes.len() as u64 {
            self.instances = vertices(device, (bytes.len() as u64).next_power_of_two());
        }
        if let Some(size) = NonZeroU64::new(bytes.len() as u64)
            && let Some(mut there) = queue.write_buffer_with(&self.instances, 0, size)
        {
            there.copy_from_slice(bytes);
        }
        self.count = instances.len() as u32;
    }

    /// Draws all instances.
    pub fn draw(&self, pass: &mut wgpu::RenderPass, which: Pass) {
        if self.count == 0 {
            return;
        }
        pass.set_pipeline(self.pipelines.of(which));
        pass.set_vertex_buffer(1, self.instances.slice(..));
        self.mesh.draw(pass, self.count);
    }
}

/// The layout of a vertex buffer whose elements are `T`.
pub fn vertex_buffer<T>(
    step_mode: wgpu::VertexStepMode,
    attributes: &[wgpu::VertexAttribute],
) -> Option<wgpu::VertexBufferLayout<'_>> {
    Some(wgpu::VertexBufferLayout {
        array_stride: size_of::<T>() as u64,
        step_mode,
        attributes,
    })
}

fn vertices(device: &wgpu::Device, size: u64) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("instances"),
        size,
        usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}
