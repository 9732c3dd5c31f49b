//! The texture that is drawn on, and its way to the host.

use anyhow::{Context, Result};

/// How pictures are stored: sRGB values, drawn on as linear ones.
pub const STORED: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
/// Format of the colours that are drawn.
pub const COLOUR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;
/// Format of the depth buffer.
pub const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// Samples of a pixel.
pub const SAMPLES: u32 = 4;

/// A picture on the device.
pub struct RenderTarget {
    /// Pixels.
    pub size: [u32; 2],
    stored: wgpu::Texture,
    pub(super) drawn: wgpu::TextureView,
    pub(super) samples: wgpu::TextureView,
    pub(super) depth: wgpu::TextureView,
}

impl RenderTarget {
    /// A picture of so many pixels.
    pub fn new(device: &wgpu::Device, size: [u32; 2]) -> RenderTarget {
        let texture = |format, samples, usage, views: &[_]| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some("target"),
                size: wgpu::Extent3d {
                    width: size[0],
                    height: size[1],
                    depth_or_array_layers: 1,
                },
                mip_level_count: 1,
                sample_count: samples,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: usage | wgpu::TextureUsages::RENDER_ATTACHMENT,
                view_formats: views,
            })
        };
        let used = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC;
        let stored = texture(STORED, 1, used, &[COLOUR]);
        let none = wgpu::TextureUsages::empty();
        let view = |texture: &wgpu::Texture, format| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                format: Some(format),
                ..Default::default()
            })
        };
        RenderTarget {
            size,
            drawn: view(&stored, COLOUR),
            samples: view(&texture(COLOUR, SAMPLES, none, &[]), COLOUR),
            depth: view(&texture(DEPTH, SAMPLES, none, &[]), DEPTH),
            stored,
        }
    }

    /// Width over height.
    pub fn aspect(&self) -> f32 {
        self.size[0] as f32 / self.size[1] as f32
    }

    /// The picture as a window's toolkit shows it.
    pub fn shown(&self) -> wgpu::TextureView {
        self.stored.create_view(&Default::default())
    }

    /// Waits for the picture: sRGB, rows from the top, `[height][width][3]`.
    ///
    /// # Errors
    /// The device was lost.
    pub fn read(&self, device: &wgpu::Device, queue: &wgpu::Queue) -> Result<Vec<u8>> {
        let [width, height] = self.size;
        // Rows of a copy begin at multiples of 256 bytes.
        let row = (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("picture"),
            size: u64::from(row) * u64::from(height),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = device.create_command_encoder(&Default::default());
        encoder.copy_texture_to_buffer(
            self.stored.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &buffer,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(row),
                    rows_per_image: None,
                },
            },
            self.stored.size(),
        );
        queue.submit([encoder.finish()]);
        let (done, wait) = std::sync::mpsc::channel();
        buffer
            .slice(..)
            .map_async(wgpu::MapMode::Read, move |result| {
                // The receiver outlives the wait below, or nobody wants to know any more.
                let _ = done.send(result);
            });
        device
            .poll(wgpu::PollType::wait_indefinitely())
            .context("the GPU stopped while drawing")?;
        wait.recv()?.context("the GPU stopped while drawing")?;
        let mapped = buffer.slice(..).get_mapped_range()?;
        let rows = mapped.chunks_exact(row as usize);
        let pixels = rows.flat_map(|row| row[..4 * width as usize].chunks_exact(4));
        Ok(pixels
            .flat_map(|pixel| [pixel[0], pixel[1], pixel[2]])
            .collect())
    }
}
