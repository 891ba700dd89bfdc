//! Pass `probes/seed`: new probes of a volume that has moved show the next coarser level until their first update.

use super::ProbeField;
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Recorder, rectangle};

pub struct ProbeSeed {
    kernel: Kernel,
    bindings: Bindings,
    groups: [u32; 2],
}

impl ProbeSeed {
    /// `resources` are those of the voxels.
    ///
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(
        gpu: &Gpu,
        field: &ProbeField,
        resources: &[(&str, wgpu::BindingResource<'_>)],
    ) -> Result<Self, GpuError> {
        let atlas = field.atlas();
        let kernel = Kernel::new(
            gpu,
            &KernelSpec {
                shader: "probes/seed",
                overrides: &[
                    ("IRRADIANCE_TEXELS", f64::from(atlas.irradiance_texels)),
                    ("DISTANCE_TEXELS", f64::from(atlas.distance_texels)),
                ],
                offered: &field.layout_constants(),
                ..Default::default()
            },
        )?;
        let mut all = resources.to_vec();
        all.extend(field.update_resources());
        all.push(("probe_places", field.places().as_entire_binding()));
        Ok(Self {
            bindings: kernel.bind(gpu, &all),
            kernel,
            groups: rectangle(atlas.slots),
        })
    }

    /// After pass `probes/classify`, before pass `probes/trace`.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        recorder.run(&self.kernel, &self.bindings, self.groups);
    }
}
