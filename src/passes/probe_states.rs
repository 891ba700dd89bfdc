//! Pass `probe_states`: where each probe stands, by what is stone. Once for a new field, and after
//! edits.

use super::ProbeField;
use crate::{
    gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Recorder},
    probes::Layout as _,
};

/// Most workgroups along one axis that every device supports.
const MOST_GROUPS: u32 = 65_535;

pub struct ProbeStates {
    kernel: Kernel,
    bindings: Bindings,
    groups: [u32; 3],
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
            groups: [slots.min(MOST_GROUPS), slots.div_ceil(MOST_GROUPS), 1],
        })
    }

    /// After [`ProbeField::begin_frame`], before pass `probe_rays`.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        recorder.compute("probe_states", |pass| {
            self.kernel.dispatch(pass, &self.bindings, self.groups);
        });
    }
}
