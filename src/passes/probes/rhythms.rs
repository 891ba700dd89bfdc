//! Pass `probes/rhythms`: finds which share of each active probe's light comes from lamps that have rhythms.

use super::ProbeField;
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Recorder, rectangle};

pub struct ProbeRhythms {
    kernel: Kernel,
    bindings: Bindings,
    most: [u32; 2],
    dispatch: wgpu::Buffer,
}

impl ProbeRhythms {
    /// `None` where lamps are not told apart. `scene`: the resources of the scene's offer.
    ///
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(
        gpu: &Gpu,
        field: &ProbeField,
        scene: &[(&str, wgpu::BindingResource<'_>)],
    ) -> Result<Option<Self>, GpuError> {
        let Some(rhythms) = field.rhythms() else {
            return Ok(None);
        };
        let sets = field.kept_hits().map_or(0, |kept| kept.sets);
        let kernel = Kernel::new(
            gpu,
            &KernelSpec {
                shader: "probes/rhythms",
                overrides: &[("HIT_SETS", f64::from(sets))],
                offered: &field.layout_constants(),
                ..Default::default()
            },
        )?;
        let all: Vec<_> = (scene.iter().cloned())
            .chain(field.update_resources())
            .chain([("probe_rhythms", rhythms.as_entire_binding())])
            .collect();
        Ok(Some(Self {
            bindings: kernel.bind(gpu, &all),
            kernel,
            most: rectangle(field.atlas().slots),
            dispatch: field.dispatch().clone(),
        }))
    }

    /// After pass `probes/blend`.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        let active = (&self.dispatch, ProbeField::PROBES_OFFSET);
        recorder.run_indirect(&self.kernel, &self.bindings, self.most, active);
    }
}
