//! The world on the GPU: what every pass may bind by name.

use glam::{IVec3, UVec3};

use super::GpuBodies;
use crate::{
    gpu::{Gpu, GpuError},
    world::voxels::{Brick, CELL, Edit, Voxels, grid_cells},
};

crate::shared! {
    in scene;

    /// The extent of the grid, and where it lies.
    pub struct GpuGridInfo as GridInfo {
        /// World-space coordinates of the grid's corner.
        pub origin_ws: [f32; 3],
        /// log2 of the grid's extent in cells along x, and along x and y together: the shifts of an index.
        pub shift_y: u32,
        /// Extent in voxels, each a power of two. Voxels beyond the world's size are air.
        pub extent: [u32; 3],
        pub shift_z: u32,
        /// Of the world, in voxels.
        pub size: [u32; 3],
        pub _pad: u32,
    }
}

impl GpuGridInfo {
    /// For a world of `size` voxels whose corner lies at `origin`.
    pub fn new(size: UVec3, origin: IVec3) -> Self {
        let cells = grid_cells(size);
        let bits = cells.map(|n| n.trailing_zeros());
        Self {
            origin_ws: origin.as_vec3().to_array(),
            shift_y: bits.x,
            extent: (cells * CELL).to_array(),
            shift_z: bits.x + bits.y,
            size: size.to_array(),
            _pad: 0,
        }
    }
}

/// Bytes of GPU memory, as `--json` gives them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct MemoryUse {
    pub voxels: u64,
    pub probes: u64,
    pub total: u64,
}

/// The brick map on the GPU. A clone is another handle to the same buffers.
#[derive(Clone)]
pub struct GpuVoxels {
    pub size: UVec3,
    /// World space of the grid's first corner.
    pub origin: IVec3,
    pub info: wgpu::Buffer,
    pub grid: wgpu::Buffer,
    pub masks: wgpu::Buffer,
    pub materials: wgpu::Buffer,
    /// What rays meet besides the grid.
    pub bodies: GpuBodies,
}

/// Bytes of a brick's mask and of its materials.
pub const MASK_BYTES: u64 = size_of::<[u32; 16]>() as u64;
pub const MATERIAL_BYTES: u64 = size_of::<Brick>() as u64;

/// Most spare bricks of a new world. Whoever outgrows the buffers waits until all passes are bound anew (4 to 14 ms), so nobody's first
/// strokes should: a ball of radius 2 takes at most eight new bricks, and all of these take 2.4 MB.
const SPARE_BRICKS: u64 = 4096;

/// Bricks that buffers for a new world of `size` voxels in `bricks` bricks have room for.
pub(super) fn with_spare_bricks(gpu: &Gpu, size: UVec3, bricks: u64) -> u64 {
    room_for(gpu, size, bricks, SPARE_BRICKS)
}

/// The spare bricks, too, if the adapter can hold them; but no more bricks than the world has cells.
fn room_for(gpu: &Gpu, size: UVec3, bricks: u64, spare: u64) -> u64 {
    let cells = size.map(|n| n.div_ceil(CELL)).as_u64vec3();
    let ample = (bricks + spare).min(cells.element_product()).max(bricks);
    let fits = gpu.check_buffer("voxel_materials", ample * MATERIAL_BYTES);
    if fits.is_ok() { ample } else { bricks }
}

impl GpuVoxels {
    /// Uploads the CPU's copy.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`].
    pub fn upload(gpu: &Gpu, voxels: &Voxels, origin: IVec3) -> Result<Self, GpuError> {
        let (grid, masks, materials) = voxels.raw();
        let info = GpuGridInfo::new(voxels.size(), origin);
        Ok(Self {
            size: voxels.size(),
            origin,
            info: gpu.uniform_buffer("grid_info", &info),
            grid: gpu.storage_buffer_of("grid", grid)?,
            masks: gpu.storage_buffer_of("masks", masks)?,
            materials: gpu.storage_buffer_of("voxel_materials", materials)?,
            bodies: GpuBodies::none(gpu)?,
        })
    }

    /// Reads the structure back, once, for collision, picking and edits.
    ///
    /// # Errors
    /// [`GpuError::Device`] when the device is lost.
    pub fn read_back(&self, gpu: &Gpu) -> Result<Voxels, GpuError> {
        let cells = u64::from(grid_cells(self.size).element_product());
        let grid = gpu.read_buffer_range(&self.grid, 0, (cells * 4).max(16))?;
        let bricks = (self.masks.size() / MASK_BYTES).min(self.materials.size() / MATERIAL_BYTES);
        let masks = gpu.read_buffer_range::<u32>(&self.masks, 0, bricks * MASK_BYTES)?;
        let materials = gpu.read_buffer_range::<u8>(&self.materials, 0, bricks * MATERIAL_BYTES)?;
        Ok(Voxels::from_raw(
            self.size,
            grid[..cells as usize].to_vec(),
            masks.as_chunks::<16>().0.to_vec(),
            materials.as_chunks::<{ size_of::<Brick>() }>().0.to_vec(),
        ))
    }

    /// The same voxels in larger buffers, when the bricks of the CPU's copy no longer fit after an edit; `None`
    /// when they fit. Every kernel bound to the old buffers must then be bound to the new ones. `self` does not
    /// change.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`].
    pub fn with_room_for(&self, gpu: &Gpu, voxels: &Voxels) -> Result<Option<Self>, GpuError> {
        let needed = voxels.raw().1.len() as u64;
        if needed * MASK_BYTES <= self.masks.size()
            && needed * MATERIAL_BYTES <= self.materials.size()
        {
            return Ok(None);
        }
        // Half as many again, so that continued digging does not allocate buffers at every stroke.
        let bricks = room_for(gpu, self.size, needed, needed / 2);
        let masks = gpu.storage_buffer("masks", bricks * MASK_BYTES)?;
        let materials = gpu.storage_buffer("voxel_materials", bricks * MATERIAL_BYTES)?;
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        for (old, new) in [(&self.masks, &masks), (&self.materials, &materials)] {
            encoder.copy_buffer_to_buffer(old, 0, new, 0, old.size());
        }
        gpu.queue.submit([encoder.finish()]);
        Ok(Some(Self {
            masks,
            materials,
            ..self.clone()
        }))
    }

    /// Follows an edit of the CPU's copy: writes the bricks and the rows of the grid that the edit changed.
    ///
    /// # Panics
    /// Without room for the bricks: see [`Self::with_room_for`].
    pub fn write(&self, gpu: &Gpu, voxels: &Voxels, edit: &Edit) {
        let (grid, masks, materials) = voxels.raw();
        for range in &edit.bricks {
            let (first, end) = (range.start as u64, range.end as u64);
            assert!(
                end * MATERIAL_BYTES <= self.materials.size(),
                "no room for the bricks {range:?}"
            );
            let masks: &[u8] = bytemuck::cast_slice(&masks[range.clone()]);
            let materials: &[u8] = bytemuck::cast_slice(&materials[range.clone()]);
            gpu.queue
                .write_buffer(&self.masks, first * MASK_BYTES, masks);
            gpu.queue
                .write_buffer(&self.materials, first * MATERIAL_BYTES, materials);
        }
        for range in &edit.grid {
            let words: &[u8] = bytemuck::cast_slice(&grid[range.clone()]);
            gpu.queue
                .write_buffer(&self.grid, range.start as u64 * 4, words);
        }
    }

    /// The bindings of `shaders/scene/voxels.wesl` and `shaders/scene/bodies.wesl`.
    pub fn resources(&self) -> [(&'static str, wgpu::BindingResource<'_>); 10] {
        let [bodies, before, lit, near, shaded, touched] = self.bodies.resources();
        [
            bodies,
            before,
            lit,
            near,
            shaded,
            touched,
            ("grid_info", self.info.as_entire_binding()),
            ("grid", self.grid.as_entire_binding()),
            ("masks", self.masks.as_entire_binding()),
            ("voxel_materials", self.materials.as_entire_binding()),
        ]
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        self.grid.size() + self.masks.size() + self.materials.size() + self.bodies.bytes()
    }
}
