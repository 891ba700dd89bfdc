//! Pass `probes/blend`: averages the light of a frame's rays into the map of each active probe.

use super::ProbeField;
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Recorder, rectangle};

pub struct ProbeBlend {
    kernel: Kernel,
    bindings: Bindings,
    most: [u32; 2],
    dispatch: wgpu::Buffer,
}

impl ProbeBlend {
    /// `scene`: the constants of the scene's offer.
    ///
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(gpu: &Gpu, field: &ProbeField, scene: &[(&str, f64)]) -> Result<Self, GpuError> {
        let [parts, lanes] = ProbeField::parts_and_lanes(gpu);
        let kernel = Kernel::new(
            gpu,
            &KernelSpec {
                shader: "probes/blend",
                overrides: &[
                    (
                        "IRRADIANCE_TEXELS",
                        f64::from(field.atlas().irradiance_texels),
                    ),
                    parts,
                    lanes,
                ],
                offered: &[scene, &field.layout_constants()[..]].concat(),
                ..Default::default()
            },
        )?;
        let slots = field.atlas().slots;
        Ok(Self {
            bindings: kernel.bind(gpu, &field.update_resources()),
            kernel,
            most: rectangle(slots),
            dispatch: field.dispatch().clone(),
        })
    }

    /// After pass `probes/trace`.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        let active = (&self.dispatch, ProbeField::PROBES_OFFSET);
        recorder.run_indirect(&self.kernel, &self.bindings, self.most, active);
    }
}
