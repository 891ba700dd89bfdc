//! Pass `probes/blend`: averages the rays of a frame into the maps of each active probe.

use std::thread;

use super::{ProbeField, source::Source};
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Recorder, made, rectangle};

pub struct ProbeBlend {
    /// One takes all probes; or the first takes those whose distances are settled, and the second those whose distances it
    /// measures. Settled ones come first, because the other kernel's may settle by this very update.
    kernels: Vec<(Kernel, Bindings)>,
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
        let offered = [scene, &field.layout_constants()[..]].concat();
        let kernel_of = |measures: bool, is_half: bool| {
            Kernel::new(
                gpu,
                &KernelSpec {
                    shader: "probes/blend",
                    overrides: &[
                        ("IRRADIANCE_TEXELS", f64::from(atlas.irradiance_texels)),
                        ("DISTANCE_TEXELS", f64::from(atlas.distance_texels.max(1))),
                        ("DISTANCES", f64::from(u8::from(measures))),
                        ("IS_HALF", f64::from(u8::from(is_half))),
                        ("PROBES_STAND", f64::from(u8::from(stands))),
                        (
                            "REJECT_LONGER",
                            f64::from(u8::from(field.source().is_some_and(Source::rejects))),
                        ),
                    ],
                    offered: &offered,
                    ..Default::default()
                },
            )
        };
        let measures = field.keeps_distances();
        // Where probes move, distances never settle.
        let kernels = if measures && stands {
            thread::scope(|threads| {
                let settled = threads.spawn(|| kernel_of(false, true));
                let others = kernel_of(true, true)?;
                Ok(vec![made(settled)?, others])
            })?
        } else {
            vec![kernel_of(measures, false)?]
        };
        let bound = |kernel: Kernel| {
            let bindings = kernel.bind(gpu, &field.update_resources());
            (kernel, bindings)
        };
        Ok(Self {
            kernels: kernels.into_iter().map(bound).collect(),
            most: rectangle(atlas.slots),
            dispatch: field.dispatch().clone(),
        })
    }

    /// After pass `probes/trace`.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        let active = (&self.dispatch, ProbeField::PROBES_OFFSET);
        for (kernel, bindings) in &self.kernels {
            recorder.run_indirect(kernel, bindings, self.most, active);
        }
    }
}
