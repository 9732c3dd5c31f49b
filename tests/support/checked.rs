//! Runs a shader through plain wgpu, apart from burn: bounds checks, zeroed workgroup memory and
//! loop bounds on, WebGPU's default limits, every error a failed test.

use bytemuck::{Pod, pod_collect_to_vec};
use footwork::gpu::shader::Shader;
use pollster::block_on;
use std::collections::HashMap;
use std::sync::{Arc, LazyLock, Mutex, PoisonError};
use wgpu::{BufferUsages, ComputePipeline, Device, Queue};

struct Checked {
    device: Device,
    queue: Queue,
    /// Software adapters take seconds to compile a shader: once each.
    pipelines: HashMap<&'static str, ComputePipeline>,
}

static CHECKED: LazyLock<Mutex<Checked>> = LazyLock::new(|| Mutex::new(open()));
static ERRORS: Mutex<Vec<String>> = Mutex::new(Vec::new());

fn open() -> Checked {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapter = block_on(instance.enumerate_adapters(wgpu::Backends::all()))
        .into_iter()
        .find(|adapter| adapter.get_info().device_type == wgpu::DeviceType::Cpu)
        .expect("a software adapter: install lavapipe (mesa-vulkan-drivers)");
    let (device, queue) =
        block_on(adapter.request_device(&wgpu::DeviceDescriptor::default())).expect("a device");
    device.on_uncaptured_error(Arc::new(|error: wgpu::Error| {
        let mut errors = ERRORS.lock().unwrap_or_else(PoisonError::into_inner);
        errors.push(error.to_string());
    }));
    Checked {
        device,
        queue,
        pipelines: HashMap::new(),
    }
}

/// What a shader left in its buffers.
pub struct Outcome(Vec<Vec<u8>>);

impl Outcome {
    pub fn of<T: Pod>(&self, binding: usize) -> Vec<T> {
        pod_collect_to_vec(&self.0[binding])
    }
}

/// Runs `shader` over `groups` workgroups. `buffers` are bound in order from 0, `params` follow
/// as the uniform.
pub fn run<P: Pod>(
    shader: &'static Shader,
    groups: [u32; 3],
    buffers: &[impl AsRef<[u8]>],
    params: &P,
) -> Outcome {
    assert_eq!(buffers.len(), shader.buffers as usize, "{}", shader.name);
    let mut checked = CHECKED.lock().unwrap_or_else(PoisonError::into_inner);
    let outcome = checked.run(shader, groups, buffers, bytemuck::bytes_of(params));
    let mut errors = ERRORS.lock().unwrap_or_else(PoisonError::into_inner);
    let errors = std::mem::take(&mut *errors);
    assert!(errors.is_empty(), "{}: {}", shader.name, errors.join("\n"));
    outcome
}

impl Checked {
    fn pipeline(&mut self, shader: &'static Shader) -> ComputePipeline {
        let device = &self.device;
        let made = self.pipelines.entry(shader.name).or_insert_with(|| {
            let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(shader.name),
                source: wgpu::ShaderSource::Wgsl(shader.source.into()),
            });
            device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(shader.name),
                layout: None,
                module: &module,
                entry_point: Some(shader.name),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            })
        });
        made.clone()
    }

    fn buffer(&self, bytes: &[u8], usage: BufferUsages) -> wgpu::Buffer {
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: bytes.len() as u64,
            usage: usage | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        self.queue.write_buffer(&buffer, 0, bytes);
        buffer
    }

    fn run(
        &mut self,
        shader: &'static Shader,
        [x, y, z]: [u32; 3],
        buffers: &[impl AsRef<[u8]>],
        params: &[u8],
    ) -> Outcome {
        let pipeline = self.pipeline(shader);
        let storage = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
        let storage = |bytes: &[u8]| self.buffer(bytes, storage);
        let mut bound: Vec<_> = buffers.iter().map(|b| storage(b.as_ref())).collect();
        if !params.is_empty() {
            bound.push(self.buffer(params, BufferUsages::UNIFORM));
        }
        let entries: Vec<_> = bound
            .iter()
            .zip(0..)
            .map(|(buffer, binding)| wgpu::BindGroupEntry {
                binding,
                resource: buffer.as_entire_binding(),
            })
            .collect();
        let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(0),
            entries: &entries,
        });
        let mut encoder = self.device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.dispatch_workgroups(x, y, z);
        }
        let copies: Vec<_> = bound[..buffers.len()]
            .iter()
            .map(|buffer| {
                let copy = self.device.create_buffer(&wgpu::BufferDescriptor {
                    label: None,
                    size: buffer.size(),
                    usage: BufferUsages::MAP_READ | BufferUsages::COPY_DST,
                    mapped_at_creation: false,
                });
                encoder.copy_buffer_to_buffer(buffer, 0, &copy, 0, buffer.size());
                copy
            })
            .collect();
        self.queue.submit([encoder.finish()]);
        for copy in &copies {
            copy.map_async(wgpu::MapMode::Read, .., |mapped| mapped.expect("mapped"));
        }
        self.device
            .poll(wgpu::PollType::wait_indefinitely())
            .expect("a device that works");
        let read = |copy: &wgpu::Buffer| copy.get_mapped_range(..).expect("mapped").to_vec();
        Outcome(copies.iter().map(read).collect())
    }
}
