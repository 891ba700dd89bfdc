//! Pass `surface_cache/cell_shadows`: which lamps stone hides from whole cells of the world.

use super::shared::CELLS_A_GROUP;
use crate::{
    gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Offer, Recorder, rectangle},
    lights::Cells,
};

/// See [`lights::CellShadows`](crate::lights::CellShadows).
pub struct SurfaceCellShadows {
    kernel: Kernel,
    bindings: Bindings,
    groups: [u32; 2],
}

impl SurfaceCellShadows {
    /// `cells` are those of sight; `offer` is that of the scene and the surface cache, with the lists of lamps to write and what
    /// is kept about cells.
    ///
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(gpu: &Gpu, cells: Cells, offer: &Offer<'_>) -> Result<Self, GpuError> {
        let kernel = Kernel::new(
            gpu,
            &KernelSpec {
                shader: "surface_cache/cell_shadows",
                offered: &offer.constants,
                ..Default::default()
            },
        )?;
        let groups = cells.number().div_ceil(CELLS_A_GROUP.into());
        Ok(Self {
            bindings: kernel.bind(gpu, &offer.resources),
            kernel,
            groups: rectangle(groups as u32),
        })
    }

    /// After pass `scene/lamp_lists`.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        recorder.run(&self.kernel, &self.bindings, self.groups);
    }
}
