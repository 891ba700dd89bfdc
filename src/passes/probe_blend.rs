//! Pass `probe_blend`: averages the rays of a frame into the maps of each probe.

use super::ProbeField;
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Recorder, rectangle};

pub struct ProbeBlend {
    kernel: Kernel,
    bindings: Bindings,
    groups: [u32; 2],
}

impl ProbeBlend {
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(gpu: &Gpu, field: &ProbeField) -> Result<Self, GpuError> {
        let atlas = field.atlas();
        let kernel = Kernel::new(
            gpu,
            &KernelSpec {
                shader: "passes/probe_blend",
                overrides: &[
                    ("IRRADIANCE_TEXELS", f64::from(atlas.irradiance_texels)),
                    ("DISTANCE_TEXELS", f64::from(atlas.distance_texels)),
                    ("DISTANCE_SHARPNESS", f64::from(field.distance_sharpness())),
                ],
                ..Default::default()
            },
        )?;
        let slots = field.atlas().slots;
        Ok(Self {
            bindings: kernel.bind(gpu, &field.update_resources()),
            kernel,
            groups: rectangle(slots),
        })
    }

    pub fn record(&self, recorder: &mut Recorder<'_>) {
        recorder.run(&self.kernel, &self.bindings, self.groups);
    }
}
