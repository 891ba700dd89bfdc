//! Pass `probes/schedule`: which probes are updated in a frame, and how many workgroups that takes.

use super::ProbeField;
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Recorder, rectangle};

pub struct ProbeSchedule {
    list: (Kernel, Bindings),
    repeat: (Kernel, Bindings),
    groups: [u32; 2],
}

impl ProbeSchedule {
    /// `scene`: the constants of the scene's offer.
    ///
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(gpu: &Gpu, field: &ProbeField, scene: &[(&str, f64)]) -> Result<Self, GpuError> {
        let mut resources = field.resources().to_vec();
        resources.extend(field.schedule_resources());
        let spec = KernelSpec {
            shader: "probes/schedule",
            overrides: &[
                ("DISTANCES", f64::from(u8::from(field.keeps_distances()))),
                field.stands(),
            ],
            offered: &[scene, &field.layout_constants()[..]].concat(),
            ..Default::default()
        };
        let kernels = Kernel::of_entries(gpu, &spec, ["list", "repeat"])?;
        let [list, repeat] = kernels.map(|kernel| {
            let bindings = kernel.bind(gpu, &resources);
            (kernel, bindings)
        });
        let groups = field.atlas().slots.div_ceil(list.0.workgroup_size[0]);
        Ok(Self {
            list,
            repeat,
            groups: rectangle(groups),
        })
    }

    /// After pass `probes/classify`, before pass `probes/trace`.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        let (kernel, bindings) = &self.list;
        recorder.run(kernel, bindings, self.groups);
    }

    /// The listed probes are updated once more in this frame, with the same rays. After their first update.
    pub fn record_repeat(&self, recorder: &mut Recorder<'_>) {
        let (kernel, bindings) = &self.repeat;
        recorder.run(kernel, bindings, self.groups);
    }
}
