//! Pass `surface_cache/trace`: traces the final gather rays of the listed faces.

use super::SurfaceCache;
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Offer, Recorder};

pub struct SurfaceTrace {
    kernel: Kernel,
    bindings: Bindings,
    most: [u32; 2],
    dispatch: wgpu::Buffer,
}

impl SurfaceTrace {
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
                shader: "surface_cache/trace",
                overrides: &[("COHERENT", 0.0), ("OF_MANY", 1.0)],
                offered: &offer.constants,
                ..Default::default()
            },
        )?;
        let mut all = offer.with(faces.update_resources()).resources;
        all.push(("face_rays_out", faces.rays().as_entire_binding()));
        Ok(Self {
            bindings: kernel.bind(gpu, &all),
            kernel,
            most: faces.rays_most(size),
            dispatch: faces.dispatch().clone(),
        })
    }

    /// After passes `surface_cache/allocate` and `probes/schedule`.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        let listed = (&self.dispatch, SurfaceCache::RAYS_OFFSET);
        recorder.run_indirect(&self.kernel, &self.bindings, self.most, listed);
    }
}
