//! Pass `probes/forget_hits`: forgets the kept hits that voxels or moved probes have made wrong, under
//! `probes.hits=kept`.

use super::ProbeField;
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Recorder, rectangle};

pub struct ForgetHits {
    kernel: Kernel,
    bindings: Bindings,
    groups: [u32; 2],
}

impl ForgetHits {
    /// `None` where no hits are kept. `resources` are those of the voxels.
    ///
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(
        gpu: &Gpu,
        field: &ProbeField,
        resources: &[(&str, wgpu::BindingResource<'_>)],
    ) -> Result<Option<Self>, GpuError> {
        let Some(kept) = field.kept_hits() else {
            return Ok(None);
        };
        let spec = KernelSpec {
            shader: "probes/forget_hits",
            overrides: &[("HIT_SETS", f64::from(kept.sets))],
            ..Default::default()
        };
        let kernel = Kernel::new(gpu, &spec)?;
        let mut all = resources.to_vec();
        all.extend(field.resources());
        all.extend([
            ("probe_rays_out", field.rays().as_entire_binding()),
            ("hit_directions", kept.directions.as_entire_binding()),
            ("hit_places", kept.places.as_entire_binding()),
        ]);
        Ok(Some(Self {
            bindings: kernel.bind(gpu, &all),
            kernel,
            groups: rectangle(field.atlas().slots),
        }))
    }

    /// After the passes that place probes, before pass `probes/trace`: in every frame that may have moved a probe or
    /// shows an edit for the first time.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        recorder.run(&self.kernel, &self.bindings, self.groups);
    }
}
