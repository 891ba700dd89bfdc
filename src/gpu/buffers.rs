//! Buffers and textures, checked against the adapter's limits before they are created, and their
//! readback.

use std::sync::mpsc;

use super::{Gpu, GpuError};

/// Data that shaders read with the memory layout that it has in Rust.
pub trait Structured: bytemuck::Pod {}
impl<T: bytemuck::Pod> Structured for T {}

impl Gpu {
    /// A storage buffer of `bytes` (at least 16, rounded up to a multiple of 16), zeroed. It can be
    /// copied from and to, and can hold the arguments of indirect dispatches.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`] before anything is allocated.
    pub fn storage_buffer(&self, label: &str, bytes: u64) -> Result<wgpu::Buffer, GpuError> {
        self.check_buffer(label, bytes)?;
        Ok(self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: bytes.max(16).next_multiple_of(16),
            usage: STORAGE,
            mapped_at_creation: false,
        }))
    }

    /// A storage buffer with these contents.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`] before anything is allocated.
    pub fn storage_buffer_of<T: Structured>(
        &self,
        label: &str,
        data: &[T],
    ) -> Result<wgpu::Buffer, GpuError> {
        let bytes: &[u8] = bytemuck::cast_slice(data);
        let buffer = self.storage_buffer(label, bytes.len() as u64)?;
        self.queue.write_buffer(&buffer, 0, bytes);
        Ok(buffer)
    }

    /// A uniform buffer with this value.
    pub fn uniform_buffer<T: Structured>(&self, label: &str, value: &T) -> wgpu::Buffer {
        // Written through the queue: a buffer that is mapped at creation panics on a lost device.
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: size_of::<T>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        self.queue
            .write_buffer(&buffer, 0, bytemuck::bytes_of(value));
        buffer
    }

    /// A texture of width, height and layers, zeroed, that shaders store to and sample, and that can be
    /// copied from.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`] before anything is allocated.
    pub fn texture(
        &self,
        label: &str,
        [width, height, layers]: [u32; 3],
        format: wgpu::TextureFormat,
    ) -> Result<wgpu::Texture, GpuError> {
        let most = [
            (
                width.max(height),
                self.limits.max_texture_dimension_2d,
                "max_texture_dimension_2d",
            ),
            (
                layers,
                self.limits.max_texture_array_layers,
                "max_texture_array_layers",
            ),
        ];
        for (count, limit, limit_name) in most {
            if count > limit {
                let texel_bytes = format.block_copy_size(None).unwrap_or_default();
                let sides = [width, height, layers, texel_bytes].map(u64::from);
                return Err(GpuError::TooLarge {
                    what: format!("`{label}`, a texture of {width}×{height}×{layers} texels,"),
                    bytes: sides.iter().product(),
                    adapter: self.summary.name.clone(),
                    limit: u64::from(limit),
                    limit_name,
                    remedy: "Choose a smaller picture or layout, or another --adapter.",
                });
            }
        }
        Ok(self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d {
                width,
                height,
                depth_or_array_layers: layers,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::STORAGE_BINDING
                | wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        }))
    }

    /// Refuses a size that the adapter cannot hold in one binding.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`].
    pub fn check_buffer(&self, what: &str, bytes: u64) -> Result<(), GpuError> {
        let binding = self.limits.max_storage_buffer_binding_size;
        let whole = self.limits.max_buffer_size;
        let (limit, limit_name) = if binding <= whole {
            (binding, "max_storage_buffer_binding_size")
        } else {
            (whole, "max_buffer_size")
        };
        if bytes > limit {
            return Err(GpuError::TooLarge {
                what: what.to_owned(),
                bytes,
                adapter: self.summary.name.clone(),
                limit,
                limit_name,
                remedy: "Choose a smaller world, layout or picture, or another --adapter.",
            });
        }
        Ok(())
    }

    /// Copies a buffer back and waits for it.
    ///
    /// # Errors
    /// [`GpuError::Device`] if the device is lost.
    pub fn read_buffer<T: Structured>(&self, buffer: &wgpu::Buffer) -> Result<Vec<T>, GpuError> {
        self.read_buffer_range(buffer, 0, buffer.size())
    }

    /// Copies `bytes` from `offset` (both multiples of 4) and waits for them.
    ///
    /// # Errors
    /// [`GpuError::Device`] if the device is lost.
    pub fn read_buffer_range<T: Structured>(
        &self,
        buffer: &wgpu::Buffer,
        offset: u64,
        bytes: u64,
    ) -> Result<Vec<T>, GpuError> {
        let staging = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("readback"),
            size: bytes,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = self.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(buffer, offset, &staging, 0, bytes);
        self.queue.submit([encoder.finish()]);
        self.map(&staging)
    }

    /// Reads a 2D texture as rows of `T`, one `T` per texel.
    ///
    /// # Errors
    /// [`GpuError::Device`] if the device is lost.
    pub fn read_texture<T: Structured>(&self, texture: &wgpu::Texture) -> Result<Vec<T>, GpuError> {
        let (width, height) = (texture.width(), texture.height());
        let row = width as u64 * size_of::<T>() as u64;
        let padded = row.next_multiple_of(u64::from(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT));
        let staging = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("readback"),
            size: padded * u64::from(height),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = self.device.create_command_encoder(&Default::default());
        encoder.copy_texture_to_buffer(
            texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &staging,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(padded as u32),
                    rows_per_image: None,
                },
            },
            wgpu::Extent3d {
                width,
                height,
                depth_or_array_layers: 1,
            },
        );
        self.queue.submit([encoder.finish()]);
        let bytes: Vec<u8> = self.map(&staging)?;
        Ok(bytes
            .chunks_exact(padded as usize)
            .flat_map(|line| bytemuck::pod_collect_to_vec::<u8, T>(&line[..row as usize]))
            .collect())
    }

    fn map<T: Structured>(&self, staging: &wgpu::Buffer) -> Result<Vec<T>, GpuError> {
        let fault = |message: String| GpuError::Device(message);
        let (sender, receiver) = mpsc::channel();
        staging.map_async(wgpu::MapMode::Read, .., move |result| {
            // The receiver is gone only if the caller is.
            let _ = sender.send(result);
        });
        self.wait()?;
        receiver
            .recv()
            .map_err(|error| fault(error.to_string()))?
            .map_err(|error| fault(error.to_string()))?;
        let view = staging
            .get_mapped_range(..)
            .map_err(|error| fault(error.to_string()))?;
        Ok(bytemuck::pod_collect_to_vec(&view))
    }
}

const STORAGE: wgpu::BufferUsages = wgpu::BufferUsages::STORAGE
    .union(wgpu::BufferUsages::COPY_SRC)
    .union(wgpu::BufferUsages::COPY_DST)
    .union(wgpu::BufferUsages::INDIRECT);
