//! Pass `probes/classify`: where each probe stands, by what is stone or by what its rays say, and whether
//! there are surfaces around it.

use super::ProbeField;
use crate::{
    gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Recorder, rectangle},
    probes::Layout as _,
};

pub struct ProbeClassify {
    main: (Kernel, Bindings),
    walk: (Kernel, Bindings),
    groups: [u32; 2],
    dispatch: wgpu::Buffer,
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
        let entry = |entry| -> Result<(Kernel, Bindings), GpuError> {
            let spec = KernelSpec {
                shader: "probes/classify",
                entry,
                ..Default::default()
            };
            let kernel = Kernel::new(gpu, &spec)?;
            let bindings = kernel.bind(gpu, &all);
            Ok((kernel, bindings))
        };
        Ok(Self {
            main: entry("main")?,
            walk: entry("walk")?,
            groups: rectangle(field.volume().slots()),
            dispatch: field.dispatch().clone(),
        })
    }

    /// For a new field, and after edits. After [`ProbeField::begin_frame`], before pass `probes/schedule`.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        let (kernel, bindings) = &self.main;
        recorder.run(kernel, bindings, self.groups);
    }

    /// Statistical relocation: moves the probes that were due by what their rays found. After pass
    /// `probes/blend`.
    pub fn record_walk(&self, recorder: &mut Recorder<'_>) {
        let (kernel, bindings) = &self.walk;
        let due = (&self.dispatch, ProbeField::PROBES_OFFSET);
        recorder.run_indirect(kernel, bindings, self.groups, due);
    }
}
