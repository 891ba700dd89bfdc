//! Materials and their block textures on the GPU.

use crate::{
    gpu::{Gpu, GpuError},
    world::materials::{
        MaterialSet,
        bake::{LEVELS, TEXELS},
    },
};

/// The bindings of `shaders/scene/materials.wesl`.
pub struct GpuMaterials {
    pub table: wgpu::Buffer,
    /// The baked masks: one layer per tile, all mip levels.
    pub masks: wgpu::TextureView,
    pub sampler: wgpu::Sampler,
    /// See [`MaterialSet::brightest`].
    pub brightest: f32,
}

impl GpuMaterials {
    /// # Errors
    /// [`GpuError::TooLarge`].
    pub fn upload(gpu: &Gpu, materials: &MaterialSet) -> Result<Self, GpuError> {
        let texture = mask_texture(gpu, materials)?;
        Ok(Self {
            brightest: materials.brightest(),
            table: gpu.storage_buffer_of("materials", &materials.to_bytes())?,
            masks: texture.create_view(&wgpu::TextureViewDescriptor {
                // Needed when there is only one layer.
                dimension: Some(wgpu::TextureViewDimension::D2Array),
                ..Default::default()
            }),
            sampler: gpu.device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("block_sampler"),
                address_mode_u: wgpu::AddressMode::Repeat,
                address_mode_v: wgpu::AddressMode::Repeat,
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                mipmap_filter: wgpu::MipmapFilterMode::Linear,
                ..Default::default()
            }),
        })
    }

    /// What the shaders bind by name.
    pub fn resources(&self) -> [(&'static str, wgpu::BindingResource<'_>); 3] {
        [
            ("materials", self.table.as_entire_binding()),
            (
                "block_masks",
                wgpu::BindingResource::TextureView(&self.masks),
            ),
            (
                "block_sampler",
                wgpu::BindingResource::Sampler(&self.sampler),
            ),
        ]
    }
}

fn mask_texture(gpu: &Gpu, materials: &MaterialSet) -> Result<wgpu::Texture, GpuError> {
    // A world of plain materials still binds a texture.
    let layers = materials.tiles().len().max(1) as u32;
    if layers > gpu.limits.max_texture_array_layers {
        return Err(GpuError::TooLarge {
            what: format!("{layers} different block textures"),
            bytes: u64::from(layers) * u64::from(TEXELS * TEXELS),
            adapter: gpu.summary.name.clone(),
            limit: u64::from(gpu.limits.max_texture_array_layers),
            limit_name: "max_texture_array_layers",
            remedy: "Let materials share patterns.",
        });
    }
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("block_masks"),
        size: wgpu::Extent3d {
            width: TEXELS,
            height: TEXELS,
            depth_or_array_layers: layers,
        },
        mip_level_count: LEVELS,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::R8Unorm,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for (layer, tile) in materials.tiles().iter().enumerate() {
        for (level, bytes) in tile.levels.iter().enumerate() {
            let edge = TEXELS >> level;
            gpu.queue.write_texture(
                wgpu::TexelCopyTextureInfo {
                    texture: &texture,
                    mip_level: level as u32,
                    origin: wgpu::Origin3d {
                        x: 0,
                        y: 0,
                        z: layer as u32,
                    },
                    aspect: wgpu::TextureAspect::All,
                },
                bytes,
                wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(edge),
                    rows_per_image: Some(edge),
                },
                wgpu::Extent3d {
                    width: edge,
                    height: edge,
                    depth_or_array_layers: 1,
                },
            );
        }
    }
    Ok(texture)
}
