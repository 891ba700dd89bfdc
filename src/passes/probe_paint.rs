//! Pass `probe_paint`: the states of the probes as colours in the place of light, for the view of states.

use super::ProbeField;
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Recorder, rectangle};

pub struct ProbePaint {
    kernel: Kernel,
    bindings: Bindings,
    groups: [u32; 2],
    /// Like [`ProbeField::ambient_cubes`], with the colour of the state (linear for the display) on all sides.
    pub cubes: wgpu::Buffer,
}

impl ProbePaint {
    /// # Errors
    /// [`GpuError::TooLarge`], [`GpuError::Shader`].
    pub fn new(gpu: &Gpu, field: &ProbeField) -> Result<Self, GpuError> {
        let cubes = gpu.storage_buffer("painted_cubes", field.ambient_cubes().size())?;
        let kernel = Kernel::new(
            gpu,
            &KernelSpec {
                shader: "passes/probe_paint",
                ..Default::default()
            },
        )?;
        let mut all = field.resources().to_vec();
        all.extend(field.due_resources());
        all.push(("painted_cubes", cubes.as_entire_binding()));
        Ok(Self {
            bindings: kernel.bind(gpu, &all),
            groups: rectangle(field.atlas().slots.div_ceil(kernel.workgroup_size[0])),
            kernel,
            cubes,
        })
    }

    /// After pass `probe_blend`, before pass `shade`.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        recorder.run(&self.kernel, &self.bindings, self.groups);
    }
}
