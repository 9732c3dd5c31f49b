//! Draws a scene: once as the sun sees it, for the shadows, and once as the camera does.

use super::camera::Camera;
use super::painter::{Drawable, Layouts, Mesh, Painter, Pass, Pipelines, vertex_buffer};
use super::render_target::{DEPTH, RenderTarget};
use super::scene::{Capsule, Cuboid, Scene};
use crate::gpu::Gpu;
use crate::gpu::shader::{DRAW_CAPSULE, DRAW_CUBOID, DRAW_GROUND};
use crate::playback::meshes::{cube, sphere};
use bytemuck::{Pod, Zeroable};
use glam::camera::rh::proj::directx::orthographic;
use glam::camera::rh::view::look_at_mat4;
use glam::{Mat4, Vec3};
use wgpu::vertex_attr_array as attributes;

/// Side of the shadow map, pixels.
const SHADOWS: u32 = 2048;
/// Width of the shadows' soft edge, m.
const SOFT: f32 = 0.045;
/// Towards the sun.
const SUN: Vec3 = Vec3::new(-0.45, 0.80, 0.40);

/// `View` of `shaders/shared/light.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct View {
    clip: [[f32; 4]; 4],
    sunlit: [[f32; 4]; 4],
    eye: [f32; 3],
    haze: f32,
    sun: [f32; 3],
    soft: f32,
}

/// A pass's view on the device.
struct Bound {
    buffer: wgpu::Buffer,
    group: wgpu::BindGroup,
}

/// Draws scenes on a GPU.
pub struct Renderer {
    /// The device drawn on.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    view_layout: wgpu::BindGroupLayout,
    shadows_layout: wgpu::BindGroupLayout,
    ground: Pipelines,
    capsules: Painter,
    cuboids: Painter,
    camera: Bound,
    sun: Bound,
    depths: wgpu::TextureView,
    shadows: wgpu::BindGroup,
}

impl Renderer {
    /// On the device that burn and the kernels use.
    pub fn new(gpu: &Gpu) -> Renderer {
        let (device, queue) = (gpu.setup.device.clone(), gpu.setup.queue.clone());
        let view = view_layout(&device);
        let shadows_layout = shadows_layout(&device);
        let layouts = Layouts {
            view: &view,
            shadows: &shadows_layout,
            own: None,
        };
        let depths = shadow_map(&device);
        Renderer {
            ground: Pipelines::new(&device, DRAW_GROUND, &[], &layouts),
            capsules: capsules(&device, &layouts),
            cuboids: cuboids(&device, &layouts),
            camera: bound(&device, &view),
            sun: bound(&device, &view),
            shadows: shadows(&device, &shadows_layout, &depths),
            depths,
            view_layout: view,
            shadows_layout,
            device,
            queue,
        }
    }

    /// Pipelines of another shape: from a shader under `shaders/view`, with what it binds as group 2.
    pub fn pipelines(
        &self,
        text: &str,
        buffers: &[Option<wgpu::VertexBufferLayout>],
        own: Option<&wgpu::BindGroupLayout>,
    ) -> Pipelines {
        let layouts = Layouts {
            view: &self.view_layout,
            shadows: &self.shadows_layout,
            own,
        };
        Pipelines::new(&self.device, text, buffers, &layouts)
    }

    /// Draws a scene, and something beside it if there is any.
    pub fn draw(
        &mut self,
        scene: &Scene,
        beside: Option<&dyn Drawable>,
        camera: &Camera,
        target: &RenderTarget,
    ) {
        if let Some(drawable) = beside {
            drawable.refresh(&self.queue);
        }
        let (device, queue) = (&self.device, &self.queue);
        self.capsules.set(device, queue, &scene.capsules);
        self.cuboids.set(device, queue, &scene.cuboids);
        let reach = 1.6 * camera.distance.max(2.5);
        let sunlit = sunlit(camera.focus, reach);
        let mut view = View {
            clip: sunlit.to_cols_array_2d(),
            sunlit: sunlit.to_cols_array_2d(),
            eye: camera.eye().to_array(),
            haze: 40.0 + 4.0 * camera.distance,
            sun: SUN.normalize().to_array(),
            // At least a pixel and a half, so that edges never show steps.
            soft: (SOFT / (2.0 * reach)).max(1.5 / SHADOWS as f32),
        };
        queue.write_buffer(&self.sun.buffer, 0, bytemuck::bytes_of(&view));
        view.clip = camera.clip(target.aspect()).to_cols_array_2d();
        queue.write_buffer(&self.camera.buffer, 0, bytemuck::bytes_of(&view));
        let mut encoder = device.create_command_encoder(&Default::default());
        self.cast(&mut encoder, beside);
        self.paint(&mut encoder, beside, target);
        queue.submit([encoder.finish()]);
    }

    fn cast(&self, encoder: &mut wgpu::CommandEncoder, beside: Option<&dyn Drawable>) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("shadows"),
            depth_stencil_attachment: Some(cleared(&self.depths, wgpu::StoreOp::Store)),
            ..Default::default()
        });
        pass.set_bind_group(0, &self.sun.group, &[]);
        self.capsules.draw(&mut pass, Pass::Cast);
        self.cuboids.draw(&mut pass, Pass::Cast);
        if let Some(drawable) = beside {
            drawable.draw(&mut pass, Pass::Cast);
        }
    }

    fn paint(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        beside: Option<&dyn Drawable>,
        target: &RenderTarget,
    ) {
        let sky = wgpu::Color {
            r: 0.70,
            g: 0.77,
            b: 0.84,
            a: 1.0,
        };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("picture"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &target.samples,
                depth_slice: None,
                resolve_target: Some(&target.drawn),
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(sky),
                    store: wgpu::StoreOp::Discard,
                },
            })],
            depth_stencil_attachment: Some(cleared(&target.depth, wgpu::StoreOp::Discard)),
            ..Default::default()
        });
        pass.set_bind_group(0, &self.camera.group, &[]);
        pass.set_bind_group(1, &self.shadows, &[]);
        self.capsules.draw(&mut pass, Pass::Paint);
        self.cuboids.draw(&mut pass, Pass::Paint);
        if let Some(drawable) = beside {
            drawable.draw(&mut pass, Pass::Paint);
        }
        pass.set_pipeline(self.ground.of(Pass::Paint));
        pass.draw(0..4, 0..1);
    }
}

/// World to the shadow map's clip space: a square of half side `reach` around `focus`. It moves in
/// whole pixels, so that edges do not crawl while the camera follows.
fn sunlit(focus: Vec3, reach: f32) -> Mat4 {
    let look = look_at_mat4(SUN.normalize(), Vec3::ZERO, Vec3::Y);
    let pixel = 2.0 * reach / SHADOWS as f32;
    let at = look.transform_point3(focus);
    let (x, y) = (
        (at.x / pixel).round() * pixel,
        (at.y / pixel).round() * pixel,
    );
    let depth = 2.0 * reach + 20.0;
    orthographic(
        x - reach,
        x + reach,
        y - reach,
        y + reach,
        -at.z - depth,
        -at.z + depth,
    ) * look
}

fn capsules(device: &wgpu::Device, layouts: &Layouts) -> Painter {
    let corner = attributes![0 => Float32x4];
    let ends = attributes![1 => Float32x4, 2 => Float32x4, 3 => Float32x3];
    let buffers = [
        vertex_buffer::<[f32; 4]>(wgpu::VertexStepMode::Vertex, &corner),
        vertex_buffer::<Capsule>(wgpu::VertexStepMode::Instance, &ends),
    ];
    let pipelines = Pipelines::new(device, DRAW_CAPSULE, &buffers, layouts);
    Painter::new(device, pipelines, Mesh::new(device, &sphere(18, 5)))
}

fn cuboids(device: &wgpu::Device, layouts: &Layouts) -> Painter {
    let corner = attributes![0 => Float32x3, 1 => Float32x3];
    let instance = attributes![2 => Float32x3, 3 => Float32x3, 4 => Float32x4, 5 => Float32x3];
    let buffers = [
        vertex_buffer::<[[f32; 3]; 2]>(wgpu::VertexStepMode::Vertex, &corner),
        vertex_buffer::<Cuboid>(wgpu::VertexStepMode::Instance, &instance),
    ];
    let pipelines = Pipelines::new(device, DRAW_CUBOID, &buffers, layouts);
    Painter::new(device, pipelines, Mesh::new(device, &cube()))
}

fn view_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("view"),
        entries: &[wgpu::BindGroupLayoutEntry {
            binding: 0,
            visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Uniform,
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        }],
    })
}

fn shadows_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::FRAGMENT,
        ty,
        count: None,
    };
    let depth = wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Depth,
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    let compare = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Comparison);
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("shadows"),
        entries: &[entry(0, depth), entry(1, compare)],
    })
}

fn shadow_map(device: &wgpu::Device) -> wgpu::TextureView {
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("shadows"),
        size: wgpu::Extent3d {
            width: SHADOWS,
            height: SHADOWS,
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: DEPTH,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    texture.create_view(&Default::default())
}

fn shadows(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    depths: &wgpu::TextureView,
) -> wgpu::BindGroup {
    let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
        compare: Some(wgpu::CompareFunction::LessEqual),
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        ..Default::default()
    });
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("shadows"),
        layout,
        entries: &[
            wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::TextureView(depths),
            },
            wgpu::BindGroupEntry {
                binding: 1,
                resource: wgpu::BindingResource::Sampler(&sampler),
            },
        ],
    })
}

fn bound(device: &wgpu::Device, layout: &wgpu::BindGroupLayout) -> Bound {
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("view"),
        size: size_of::<View>() as u64,
        usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("view"),
        layout,
        entries: &[wgpu::BindGroupEntry {
            binding: 0,
            resource: buffer.as_entire_binding(),
        }],
    });
    Bound { buffer, group }
}

fn cleared(
    view: &wgpu::TextureView,
    store: wgpu::StoreOp,
) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    wgpu::RenderPassDepthStencilAttachment {
        view,
        depth_ops: Some(wgpu::Operations {
            load: wgpu::LoadOp::Clear(1.0),
            store,
        }),
        stencil_ops: None,
    }
}
