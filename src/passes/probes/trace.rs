//! Pass `probes/trace`: traces every ray of the active probes and shades its hit.

use super::ProbeField;
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Offer, Recorder, rectangle};

pub struct ProbeTrace {
    kernel: Kernel,
    bindings: Bindings,
    most: [u32; 2],
    dispatch: wgpu::Buffer,
}

impl ProbeTrace {
    /// `offer` is that of the scene and the probes.
    ///
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(gpu: &Gpu, field: &ProbeField, offer: &Offer<'_>) -> Result<Self, GpuError> {
        let sets = field.kept_hits().map_or(0, |kept| kept.sets);
        let kernel = Kernel::new(
            gpu,
            &KernelSpec {
                shader: "probes/trace",
                overrides: &[
                    ("COHERENT", 0.0),
                    ("OF_MANY", 1.0),
                    ("HIT_SETS", f64::from(sets)),
                ],
                offered: &offer.constants,
                ..Default::default()
            },
        )?;
        let all = offer.with([("probe_rays_out", field.rays().as_entire_binding())]);
        // The buffer of the rays fits a binding, so the number of rays fits a u32.
        let rays = field.atlas().slots * field.rays_per_probe();
        let groups = rays.div_ceil(kernel.workgroup_size[0]);
        Ok(Self {
            bindings: kernel.bind(gpu, &all.resources),
            kernel,
            most: rectangle(groups),
            dispatch: field.dispatch().clone(),
        })
    }

    /// After pass `probes/schedule`.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        let active = (&self.dispatch, ProbeField::RAYS_OFFSET);
        recorder.run_indirect(&self.kernel, &self.bindings, self.most, active);
    }
}
