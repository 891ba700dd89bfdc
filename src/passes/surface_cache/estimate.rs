//! Pass `surface_cache/estimate`: what the probes tell of the light of the listed faces.

use super::SurfaceCache;
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Offer, Recorder};

pub struct SurfaceEstimate {
    kernel: Kernel,
    bindings: Bindings,
    most: [u32; 2],
    dispatch: wgpu::Buffer,
}

impl SurfaceEstimate {
    /// For pictures of `size` pixels. `offer` is that of the scene and the probes, with a list of requests for this pass alone: it may run
    /// beside all others that request probes.
    ///
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(
        gpu: &Gpu,
        size: [u32; 2],
        faces: &SurfaceCache,
        offer: &Offer<'_>,
    ) -> Result<Self, GpuError> {
        let kernel = Kernel::new(
            gpu,
            &KernelSpec {
                shader: "surface_cache/estimate",
                offered: &offer.constants,
                ..Default::default()
            },
        )?;
        let all = offer.with(faces.update_resources()).resources;
        Ok(Self {
            bindings: kernel.bind(gpu, &all),
            kernel,
            most: faces.resolve_most(size),
            dispatch: faces.dispatch().clone(),
        })
    }

    /// After pass `surface_cache/allocate`, before pass `surface_cache/resolve`.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        let listed = (&self.dispatch, SurfaceCache::RESOLVE_OFFSET);
        recorder.run_indirect(&self.kernel, &self.bindings, self.most, listed);
    }
}
