//! Pass `probes/blend_distances`: averages the lengths of a frame's rays into the maps of those probes whose distances have not settled.

use super::{ProbeField, source::Source};
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Recorder, rectangle};

pub struct ProbeBlendDistances {
    kernel: Kernel,
    bindings: Bindings,
    most: [u32; 2],
    dispatch: wgpu::Buffer,
}

impl ProbeBlendDistances {
    /// `None` where probes keep no distances. `scene`: the constants of the scene's offer.
    ///
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(
        gpu: &Gpu,
        field: &ProbeField,
        scene: &[(&str, f64)],
    ) -> Result<Option<Self>, GpuError> {
        if !field.keeps_distances() {
            return Ok(None);
        }
        let rejects = field.source().is_some_and(Source::rejects);
        let kernel = Kernel::new(
            gpu,
            &KernelSpec {
                shader: "probes/blend_distances",
                overrides: &[
                    ("DISTANCE_TEXELS", f64::from(field.atlas().distance_texels)),
                    ("REJECT_LONGER", f64::from(u8::from(rejects))),
                    ProbeField::parts(gpu),
                    field.stands(),
                ],
                offered: &[scene, &field.layout_constants()[..]].concat(),
                ..Default::default()
            },
        )?;
        Ok(Some(Self {
            bindings: kernel.bind(gpu, &field.update_resources()),
            kernel,
            most: rectangle(field.atlas().slots),
            dispatch: field.dispatch().clone(),
        }))
    }

    /// After pass `probes/trace`. It shares nothing that is written with pass `probes/blend`.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        let measured = (&self.dispatch, ProbeField::DISTANCES_OFFSET);
        recorder.run_indirect(&self.kernel, &self.bindings, self.most, measured);
    }
}
