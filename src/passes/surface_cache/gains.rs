//! Pass `surface_cache/gains`: by what the light of each face is multiplied, while lamps go up and down.

use super::SurfaceCache;
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Offer, Recorder};

pub struct SurfaceGains {
    kernel: Kernel,
    bindings: Bindings,
    groups: [u32; 2],
}

impl SurfaceGains {
    /// `None` where no lamps are told apart. `offer` is that of the scene and the probes.
    ///
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(
        gpu: &Gpu,
        faces: &SurfaceCache,
        offer: &Offer<'_>,
    ) -> Result<Option<Self>, GpuError> {
        if !faces.has_gains() {
            return Ok(None);
        }
        let kernel = Kernel::new(
            gpu,
            &KernelSpec {
                shader: "surface_cache/gains",
                offered: &offer.constants,
                ..Default::default()
            },
        )?;
        let all = offer.with(faces.update_resources()).resources;
        let [threads, ..] = kernel.workgroup_size;
        Ok(Some(Self {
            bindings: kernel.bind(gpu, &all),
            kernel,
            groups: faces.groups_of_entries(threads),
        }))
    }

    /// After the lamps of the frame are known, before pass `view/shade`.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        recorder.run(&self.kernel, &self.bindings, self.groups);
    }
}
