//! Pass `probes/visibility`: which of the surfaces around it each probe sees, and where its back-side probe is. Runs
//! after pass `probes/classify`.

use super::ProbeField;
use crate::{
    gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Recorder, rectangle},
    probes::Layout as _,
};

pub struct ProbeVisibility {
    kernel: Kernel,
    bindings: Bindings,
    groups: [u32; 2],
}

impl ProbeVisibility {
    /// `resources` are those of the voxels.
    ///
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(
        gpu: &Gpu,
        field: &ProbeField,
        resources: &[(&str, wgpu::BindingResource<'_>)],
    ) -> Result<Self, GpuError> {
        let kernel = Kernel::new(
            gpu,
            &KernelSpec {
                shader: "probes/visibility",
                overrides: &[("THREADS", f64::from(gpu.threads(1024, 256)))],
                offered: &field.layout_constants(),
                ..Default::default()
            },
        )?;
        let mut all = resources.to_vec();
        all.extend(field.state_resources());
        let slots = field.volume().slots();
        Ok(Self {
            bindings: kernel.bind(gpu, &all),
            kernel,
            groups: rectangle(slots),
        })
    }

    /// After pass `probes/classify`, before pass `probes/trace`.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        recorder.run(&self.kernel, &self.bindings, self.groups);
    }
}
