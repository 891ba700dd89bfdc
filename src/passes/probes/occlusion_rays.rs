//! Pass `probes/occlusion_rays`: sends a shadow ray to each lamp of the occlusion field from where the rays of the
//! active probes ended.

use super::ProbeField;
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Offer, Recorder, rectangle};

pub struct OcclusionRays {
    kernel: Kernel,
    bindings: Bindings,
    most: [u32; 2],
    dispatch: wgpu::Buffer,
}

impl OcclusionRays {
    /// `offer` is that of the scene and the probes. `None` where the field is off.
    ///
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(gpu: &Gpu, field: &ProbeField, offer: &Offer<'_>) -> Result<Option<Self>, GpuError> {
        if !field.occlusion().layout().is_kept() {
            return Ok(None);
        }
        let kernel = Kernel::new(
            gpu,
            &KernelSpec {
                shader: "probes/occlusion_rays",
                overrides: &[("COHERENT", 0.0)],
                offered: &offer.constants,
                ..Default::default()
            },
        )?;
        let all = offer.with(
            field
                .occlusion()
                .update_resources()
                .into_iter()
                .chain([("probe_rays", field.rays().as_entire_binding())]),
        );
        // The buffer of the rays fits a binding, so the number of rays fits a u32.
        let rays = field.atlas().slots * field.rays_per_probe();
        let groups = rays.div_ceil(kernel.workgroup_size[0]);
        Ok(Some(Self {
            bindings: kernel.bind(gpu, &all.resources),
            kernel,
            most: rectangle(groups),
            dispatch: field.dispatch().clone(),
        }))
    }

    /// After pass `probes/trace`.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        let active = (&self.dispatch, ProbeField::RAYS_OFFSET);
        recorder.run_indirect(&self.kernel, &self.bindings, self.most, active);
    }
}
