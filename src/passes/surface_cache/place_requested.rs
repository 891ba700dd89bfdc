//! Pass `surface_cache/place_requested`: gives the faces that rays have requested places in the table.

use super::SurfaceCache;
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Offer, Recorder};

pub struct PlaceRequested {
    kernel: Kernel,
    bindings: Bindings,
}

impl PlaceRequested {
    /// `scene` is the offer of the voxels, the bodies and the view.
    ///
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(gpu: &Gpu, faces: &SurfaceCache, scene: &Offer<'_>) -> Result<Self, GpuError> {
        let kernel = Kernel::new(
            gpu,
            &KernelSpec {
                shader: "surface_cache/place_requested",
                overrides: &[("THREADS", f64::from(gpu.threads(1024, 256)))],
                offered: &scene.constants,
                ..Default::default()
            },
        )?;
        let all = scene.with(faces.update_resources()).resources;
        Ok(Self {
            bindings: kernel.bind(gpu, &all),
            kernel,
        })
    }

    /// After pass `surface_cache/trace`; the places are for pass `surface_cache/allocate` of the next frame.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        recorder.compute(&self.kernel.label, |pass| {
            self.kernel.dispatch(pass, &self.bindings, [1, 1, 1]);
        });
    }
}
