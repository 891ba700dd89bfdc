//! Pass `surface_cache/lamps`: finds out which lamps the faces see that the last frame listed.

use super::SurfaceCache;
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Offer, Recorder};

pub struct SurfaceLamps {
    kernel: Kernel,
    bindings: Bindings,
    most: [u32; 2],
    dispatch: wgpu::Buffer,
}

impl SurfaceLamps {
    /// For pictures of `size` pixels. `offer` is that of the scene and the probes.
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
                shader: "surface_cache/lamps",
                offered: &offer.constants,
                ..Default::default()
            },
        )?;
        let all = offer.with(faces.update_resources()).resources;
        Ok(Self {
            bindings: kernel.bind(gpu, &all),
            kernel,
            most: faces.lamps_most(size),
            dispatch: faces.dispatch().clone(),
        })
    }

    /// Before pass `surface_cache/allocate`, which lists the faces of this frame in place of those.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        let listed = (&self.dispatch, SurfaceCache::LAMPS_OFFSET);
        recorder.run_indirect(&self.kernel, &self.bindings, self.most, listed);
    }
}
