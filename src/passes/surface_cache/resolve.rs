//! Pass `surface_cache/resolve`: adds the rays of a frame to the light of the listed faces.

use super::SurfaceCache;
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Offer, Recorder};

pub struct SurfaceResolve {
    kernel: Kernel,
    bindings: Bindings,
    most: [u32; 2],
    dispatch: wgpu::Buffer,
}

impl SurfaceResolve {
    /// For pictures of `size` pixels. `offer` is that of the scene.
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
                shader: "surface_cache/resolve",
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

    /// After passes `surface_cache/trace` and `surface_cache/estimate`.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        let listed = (&self.dispatch, SurfaceCache::RESOLVE_OFFSET);
        recorder.run_indirect(&self.kernel, &self.bindings, self.most, listed);
    }
}
