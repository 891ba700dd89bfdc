//! Pass `probes/occlusion_blend`: averages what pass `probes/occlusion_rays` found into the maps of each active probe.

use super::ProbeField;
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Recorder, rectangle};

pub struct OcclusionBlend {
    kernel: Kernel,
    bindings: Bindings,
    most: [u32; 2],
    dispatch: wgpu::Buffer,
}

impl OcclusionBlend {
    /// `None` where the field is off.
    ///
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(gpu: &Gpu, field: &ProbeField) -> Result<Option<Self>, GpuError> {
        let occlusion = field.occlusion();
        if !occlusion.layout().is_kept() {
            return Ok(None);
        }
        let texels = f64::from(occlusion.layout().texels);
        let constants: Vec<_> = (occlusion.constants().into_iter())
            .chain([("OCCLUSION_TEXELS", texels)])
            .collect();
        let kernel = Kernel::new(
            gpu,
            &KernelSpec {
                shader: "probes/occlusion_blend",
                overrides: &constants,
                ..Default::default()
            },
        )?;
        let all: Vec<_> = (field.update_resources().into_iter())
            .chain(occlusion.update_resources())
            .collect();
        Ok(Some(Self {
            bindings: kernel.bind(gpu, &all),
            kernel,
            most: rectangle(field.atlas().slots),
            dispatch: field.dispatch().clone(),
        }))
    }

    /// After pass `probes/occlusion_rays` and before pass `probes/blend`, which counts the updates of new probes.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        let active = (&self.dispatch, ProbeField::PROBES_OFFSET);
        recorder.run_indirect(&self.kernel, &self.bindings, self.most, active);
    }
}
