//! Pass `probes/blend`: averages the rays of a frame into the maps of each active probe.

use super::{ProbeField, source::Source};
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
        let atlas = field.atlas();
        let stands = field.source().is_none();
        let parts = if gpu.summary.is_software() { 1 } else { 4 };
        let kernel = Kernel::new(
            gpu,
            &KernelSpec {
                shader: "probes/blend",
                overrides: &[
                    ("IRRADIANCE_TEXELS", f64::from(atlas.irradiance_texels)),
                    ("DISTANCE_TEXELS", f64::from(atlas.distance_texels.max(1))),
                    ("DISTANCES", f64::from(u8::from(field.keeps_distances()))),
                    ("PARTS", f64::from(parts)),
                    ("PROBES_STAND", f64::from(u8::from(stands))),
                    (
                        "REJECT_LONGER",
                        f64::from(u8::from(field.source().is_some_and(Source::rejects))),
                    ),
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
