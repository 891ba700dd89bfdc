//! The octree of a probe field as shaders read it: `shaders/probes/octree.wesl`.

use crate::{
    gpu::{Gpu, GpuError},
    probes::{Octree, Volume, octree::TREE_WIDTH_LOG2},
};

/// The texture of the tree: one texel for volumes without one.
pub struct GpuOctree {
    texture: wgpu::Texture,
    pub view: wgpu::TextureView,
    rows: u32,
}

const WIDTH: u32 = 1 << TREE_WIDTH_LOG2;
const TEXEL_BYTES: u32 = 16;

impl GpuOctree {
    /// # Errors
    /// [`GpuError::TooLarge`] before anything is allocated.
    pub fn new(gpu: &Gpu, volume: &Volume) -> Result<Self, GpuError> {
        let texels = volume.octree().map_or(1, Octree::most_texels);
        let [width, rows] = if texels == 1 {
            [1, 1]
        } else {
            [
                WIDTH,
                u32::try_from(texels.div_ceil(u64::from(WIDTH))).unwrap_or(u32::MAX),
            ]
        };
        let what = "the octree of the probes";
        gpu.check_buffer(
            what,
            u64::from(width) * u64::from(rows) * u64::from(TEXEL_BYTES),
        )?;
        let most = gpu.limits.max_texture_dimension_2d;
        if rows > most {
            return Err(GpuError::TooLarge {
                what: what.to_owned(),
                bytes: u64::from(width) * u64::from(rows) * u64::from(TEXEL_BYTES),
                adapter: gpu.summary.name.clone(),
                limit: u64::from(most),
                limit_name: "max_texture_dimension_2d",
                remedy: "Choose a smaller layout, or another --adapter.",
            });
        }
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("probe_tree"),
            size: wgpu::Extent3d {
                width,
                height: rows,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba32Uint,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let tree = Self {
            view: texture.create_view(&Default::default()),
            texture,
            rows,
        };
        if let Some(octree) = volume.octree() {
            tree.write(gpu, octree);
        }
        Ok(tree)
    }

    /// Bytes of GPU memory.
    pub fn bytes(volume: &Volume) -> u64 {
        volume
            .octree()
            .map_or(0, |octree| octree.most_texels() * u64::from(TEXEL_BYTES))
    }

    /// Writes a tree that has changed.
    pub fn write(&self, gpu: &Gpu, octree: &Octree) {
        let mut texels = octree.texels();
        // The rooms at the end were zero, or hold cells that no cell refers to any more.
        let rows = (texels.len() as u32).div_ceil(WIDTH).min(self.rows);
        texels.resize((rows * WIDTH) as usize, [0; 4]);
        gpu.queue.write_texture(
            self.texture.as_image_copy(),
            bytemuck::cast_slice(&texels),
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(WIDTH * TEXEL_BYTES),
                rows_per_image: None,
            },
            wgpu::Extent3d {
                width: WIDTH,
                height: rows,
                depth_or_array_layers: 1,
            },
        );
    }
}
