//! Pass `surface_cache/cell_shadows`: which lamps stone hides from whole cells of the world.

use crate::{
    gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Offer, Recorder, rectangle},
    passes::scene::GpuLights,
};

/// Cells among which a workgroup looks for those that are seen.
const CELLS_A_GROUP: u64 = 16;

/// See [`lights::CellShadows`](crate::lights::CellShadows).
pub struct ExamineShadows {
    kernel: Kernel,
    bindings: Bindings,
    groups: [u32; 2],
}

impl ExamineShadows {
    /// `offer` is that of the scene and the surface cache.
    ///
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(gpu: &Gpu, lights: &GpuLights, offer: &Offer<'_>) -> Result<Self, GpuError> {
        let kernel = Kernel::new(
            gpu,
            &KernelSpec {
                shader: "surface_cache/cell_shadows",
                offered: &offer.constants,
                ..Default::default()
            },
        )?;
        let all = offer.with([lights.lists(), lights.cells_seen()]).resources;
        let groups = lights.of_sight().number().div_ceil(CELLS_A_GROUP);
        Ok(Self {
            bindings: kernel.bind(gpu, &all),
            kernel,
            groups: rectangle(groups as u32),
        })
    }

    /// After pass `scene/lamp_lists`.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        recorder.run(&self.kernel, &self.bindings, self.groups);
    }
}
