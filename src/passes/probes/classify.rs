//! Pass `probes/classify`: places each probe outside solid voxels where it can, and finds whether there are surfaces
//! around it.

use super::ProbeField;
use crate::{
    gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Recorder, rectangle},
    probes::Layout as _,
};

pub struct ProbeClassify {
    kernel: Kernel,
    bindings: Bindings,
    groups: [u32; 2],
}

impl ProbeClassify {
    /// `resources` are those of the voxels.
    ///
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(
        gpu: &Gpu,
        field: &ProbeField,
        resources: &[(&str, wgpu::BindingResource<'_>)],
    ) -> Result<Self, GpuError> {
        let mut all = resources.to_vec();
        all.extend(field.state_resources());
        // Most probes of cascades are far from an edit, and there are tens of thousands.
        let many = field.volume().levels().len() > 1;
        let threads = if many { 64 } else { gpu.threads(256, 64) };
        let spec = KernelSpec {
            shader: "probes/classify",
            overrides: &[("THREADS", f64::from(threads))],
            offered: &field.layout_constants(),
            ..Default::default()
        };
        let kernel = Kernel::new(gpu, &spec)?;
        Ok(Self {
            bindings: kernel.bind(gpu, &all),
            kernel,
            groups: rectangle(field.volume().slots()),
        })
    }

    /// Needed for a new field, and after edits. Runs after [`ProbeField::begin_frame`], before pass `probes/schedule`.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        recorder.run(&self.kernel, &self.bindings, self.groups);
    }
}
