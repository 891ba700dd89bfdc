//! The octree of a probe field as shaders read it: `shaders/probes/octree.wesl`.

use crate::{
    gpu::{Gpu, GpuError},
    probes::{Octree, Volume},
};

/// Bytes of a row of the tree.
const ROW_BYTES: u64 = 16;

/// The rows of the tree; one row for volumes without one.
pub struct GpuOctree {
    pub rows: wgpu::Buffer,
}

impl GpuOctree {
    /// # Errors
    /// [`GpuError::TooLarge`] before anything is allocated.
    pub fn new(gpu: &Gpu, volume: &Volume) -> Result<Self, GpuError> {
        let bytes = Self::bytes(volume).max(ROW_BYTES);
        let tree = Self {
            rows: gpu.storage_buffer("probe_tree", bytes)?,
        };
        if let Some(octree) = volume.octree() {
            tree.write(gpu, octree);
        }
        Ok(tree)
    }

    /// Bytes of GPU memory, with the room for edits.
    pub fn bytes(volume: &Volume) -> u64 {
        ROW_BYTES * volume.octree().map_or(0, Octree::most_rows)
    }

    /// Writes a tree that has changed. What remains at the end are cells that no cell refers to.
    pub fn write(&self, gpu: &Gpu, octree: &Octree) {
        gpu.queue
            .write_buffer(&self.rows, 0, bytemuck::cast_slice(&octree.rows()));
    }
}
