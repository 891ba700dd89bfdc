//! Pass `probe_states`: where each probe stands, by what is stone. Once for a new field, and after
//! edits.

use super::ProbeField;
use crate::{
    gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Recorder, rectangle},
    probes::Layout as _,
};

pub struct ProbeStates {
    kernel: Kernel,
    bindings: Bindings,
    groups: [u32; 2],
}

impl ProbeStates {
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
                shader: "passes/probe_states",
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

    /// After [`ProbeField::begin_frame`], before pass `probe_rays`.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        recorder.run(&self.kernel, &self.bindings, self.groups);
    }
}
