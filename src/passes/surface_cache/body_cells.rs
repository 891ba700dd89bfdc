//! Pass `surface_cache/body_cells`: lists the cells that bodies may touch.

use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Offer, Recorder};

pub struct BodyCells {
    kernel: Kernel,
    bindings: Bindings,
}

impl BodyCells {
    /// `offered`: the constants of the offer.
    pub fn spec<'a>(offered: &'a [(&'a str, f64)]) -> KernelSpec<'a> {
        KernelSpec {
            shader: "surface_cache/body_cells",
            offered,
            ..Default::default()
        }
    }

    /// `offer` is that of the scene and the surface cache.
    ///
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(gpu: &Gpu, offer: &Offer<'_>) -> Result<Self, GpuError> {
        let kernel = Kernel::new(gpu, &Self::spec(&offer.constants))?;
        Ok(Self {
            bindings: kernel.bind(gpu, &offer.resources),
            kernel,
        })
    }

    /// In frames in which bodies have moved, and in the first. Most cells around a body, and number of bodies.
    pub fn record(&self, recorder: &mut Recorder<'_>, [cells, bodies]: [u32; 2]) {
        if bodies > 0 {
            let groups = cells.div_ceil(self.kernel.workgroup_size[0]);
            recorder.run(&self.kernel, &self.bindings, [groups, bodies]);
        }
    }
}
