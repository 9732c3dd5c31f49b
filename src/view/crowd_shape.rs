//! One mesh, drawn for every environment of a training from where that keeps them.

use super::painter::{Mesh, Pass, Pipelines, vertex_buffer};
use super::renderer::Renderer;
use crate::playback::meshes::{cube, sphere};
use bytemuck::{Pod, Zeroable};

/// `Crowd` of `shaders/shared/crowd.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
pub struct CrowdParams {
    pub envs: u32,
    pub bones: u32,
    pub points: u32,
    pub columns: u32,
    pub count: u32,
    pub spacing: f32,
    pub unused: [u32; 2],
}

/// One mesh, drawn many times at positions that a shader computes.
pub struct CrowdShape {
    pipelines: Pipelines,
    mesh: Mesh,
    group: wgpu::BindGroup,
    instances: u32,
}

impl CrowdShape {
    /// Capsules, from the text of a shader that binds storage buffers and, last, the crowd as group 2.
    pub fn capsules(
        renderer: &Renderer,
        text: &str,
        bound: Vec<wgpu::BindingResource>,
        instances: u32,
    ) -> CrowdShape {
        let corner = wgpu::vertex_attr_array![0 => Float32x4];
        let corners = vertex_buffer::<[f32; 4]>(wgpu::VertexStepMode::Vertex, &corner);
        let mesh = Mesh::new(&renderer.device, &sphere(8, 2));
        CrowdShape::new(renderer, text, corners, mesh, bound, instances)
    }

    /// Boxes, from such a text.
    pub fn cuboids(
        renderer: &Renderer,
        text: &str,
        bound: Vec<wgpu::BindingResource>,
        instances: u32,
    ) -> CrowdShape {
        let corner = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3];
        let corners = vertex_buffer::<[[f32; 3]; 2]>(wgpu::VertexStepMode::Vertex, &corner);
        let mesh = Mesh::new(&renderer.device, &cube());
        CrowdShape::new(renderer, text, corners, mesh, bound, instances)
    }

    fn new(
        renderer: &Renderer,
        text: &str,
        corners: Option<wgpu::VertexBufferLayout>,
        mesh: Mesh,
        bound: Vec<wgpu::BindingResource>,
        instances: u32,
    ) -> CrowdShape {
        let device = &renderer.device;
        let layout = layout(device, bound.len() as u32);
        let entries: Vec<_> = (0..)
            .zip(bound)
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
            .collect();
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("crowd"),
            layout: &layout,
            entries: &entries,
        });
        CrowdShape {
            pipelines: renderer.pipelines(text, &[corners], Some(&layout)),
            mesh,
            group,
            instances,
        }
    }

    /// Records its draw call in a pass.
    pub fn draw(&self, pass: &mut wgpu::RenderPass, which: Pass) {
        pass.set_pipeline(self.pipelines.of(which));
        pass.set_bind_group(2, &self.group, &[]);
        self.mesh.draw(pass, self.instances);
    }
}

/// Storage buffers, and last a uniform.
fn layout(device: &wgpu::Device, count: u32) -> wgpu::BindGroupLayout {
    let entry = |binding| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::VERTEX,
        ty: wgpu::BindingType::Buffer {
            ty: match binding + 1 == count {
                true => wgpu::BufferBindingType::Uniform,
                false => wgpu::BufferBindingType::Storage { read_only: true },
            },
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    };
    let entries: Vec<_> = (0..count).map(entry).collect();
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("crowd"),
        entries: &entries,
    })
}
