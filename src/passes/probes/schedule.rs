//! Pass `probes/schedule`: which probes are updated in a frame, and how many workgroups that takes.

use super::ProbeField;
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Recorder, rectangle};

pub struct ProbeSchedule {
    list: (Kernel, Bindings),
    arguments: (Kernel, Bindings),
    groups: [u32; 2],
}

impl ProbeSchedule {
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(gpu: &Gpu, field: &ProbeField) -> Result<Self, GpuError> {
        let mut resources = field.resources().to_vec();
        resources.extend(field.schedule_resources());
        let entry = |entry| -> Result<(Kernel, Bindings), GpuError> {
            let spec = KernelSpec {
                shader: "probes/schedule",
                entry,
                ..Default::default()
            };
            let kernel = Kernel::new(gpu, &spec)?;
            let bindings = kernel.bind(gpu, &resources);
            Ok((kernel, bindings))
        };
        let list = entry("list")?;
        let groups = field.atlas().slots.div_ceil(list.0.workgroup_size[0]);
        Ok(Self {
            list,
            arguments: entry("arguments")?,
            groups: rectangle(groups),
        })
    }

    /// After pass `probes/classify`, before pass `probes/trace`.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        self.record_list(recorder);
        self.record_arguments(recorder);
    }

    /// The first part of [`record`](Self::record).
    pub fn record_list(&self, recorder: &mut Recorder<'_>) {
        let (kernel, bindings) = &self.list;
        recorder.run(kernel, bindings, self.groups);
    }

    /// The second part of [`record`](Self::record).
    pub fn record_arguments(&self, recorder: &mut Recorder<'_>) {
        let (kernel, bindings) = &self.arguments;
        recorder.compute(&kernel.label, |pass| {
            kernel.dispatch(pass, bindings, [1, 1, 1]);
        });
    }
}
