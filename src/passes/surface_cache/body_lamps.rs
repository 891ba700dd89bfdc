//! Pass `surface_cache/body_lamps`: which lamps the cells around bodies see.

use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Offer, Recorder};

pub struct BodyLamps {
    kernel: Kernel,
    bindings: Bindings,
}

impl BodyLamps {
    /// `offered`: the constants of the offer.
    pub fn spec<'a>(offered: &'a [(&'a str, f64)]) -> KernelSpec<'a> {
        KernelSpec {
            shader: "surface_cache/body_lamps",
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

    /// In frames in which a body or a lamp has moved or a voxel has changed, after passes `scene/lamp_lists` and
    /// `surface_cache/body_cells`.
    pub fn record(&self, recorder: &mut Recorder<'_>, (most, listed): ([u32; 2], &wgpu::Buffer)) {
        recorder.run_indirect(&self.kernel, &self.bindings, most, (listed, 0));
    }
}
