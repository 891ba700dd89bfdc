//! Pass `scene/distances`: the octant distances of every empty cell of the grid.

use glam::UVec3;

use super::GpuVoxels;
use crate::{
    gpu::{Gpu, GpuError, Kernel, KernelSpec, Recorder},
    world::voxels::{FARTHEST, grid_cells},
};

/// Kernels that fill in the distances of a grid whose solid cells are written.
pub struct Distances {
    start: Kernel,
    sweep: Kernel,
}

impl Distances {
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let spec = KernelSpec {
            shader: "scene/distances",
            ..Default::default()
        };
        let [start, sweep] = Kernel::of_entries(gpu, &spec, ["start", "sweep"])?;
        Ok(Self { start, sweep })
    }

    /// Overwrites all that the grid holds for empty cells.
    pub fn record(&self, gpu: &Gpu, recorder: &mut Recorder<'_>, voxels: &GpuVoxels) {
        let UVec3 { x, y, z } = grid_cells(voxels.size);
        let resources = [
            ("grid_info", voxels.info.as_entire_binding()),
            ("distance_grid", voxels.grid.as_entire_binding()),
        ];
        let start = self.start.bind(gpu, &resources);
        let sweep = self.sweep.bind(gpu, &resources);
        recorder.compute("scene/distances", |pass| {
            self.start.dispatch_threads(pass, &start, [x, y, z]);
            for _ in 1..FARTHEST {
                self.sweep.dispatch_threads(pass, &sweep, [x, y, z]);
            }
        });
    }
}
