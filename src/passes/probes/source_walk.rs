//! Pass `probes/source_walk`: moves probes out of solid voxels by what their rays find, under `probes.method=source`.

use super::ProbeField;
use crate::{
    gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Recorder, rectangle},
    parameters::SourceRelocation,
    probes::Layout as _,
};

pub struct SourceWalk {
    begin: (Kernel, Bindings),
    walk: (Kernel, Bindings),
    groups: [u32; 2],
    most: [u32; 2],
    dispatch: wgpu::Buffer,
}

impl SourceWalk {
    /// Voxels that a probe keeps from surfaces under [`SourceRelocation::Clear`].
    pub const CLEARANCE: f32 = 1.0;
    /// Share of what a probe knows about its place that it keeps per update.
    pub const KEPT: f32 = 0.95;

    /// `None` where probes do not walk. `resources` are those of the voxels.
    ///
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(
        gpu: &Gpu,
        field: &ProbeField,
        resources: &[(&str, wgpu::BindingResource<'_>)],
    ) -> Result<Option<Self>, GpuError> {
        Self::with_memory(gpu, field, resources, Self::KEPT)
    }

    /// The same with a share `kept` in place of [`Self::KEPT`]; with 0, probes know only their last update.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn with_memory(
        gpu: &Gpu,
        field: &ProbeField,
        resources: &[(&str, wgpu::BindingResource<'_>)],
        kept: f32,
    ) -> Result<Option<Self>, GpuError> {
        let Some(source) = field.source() else {
            return Ok(None);
        };
        let clearance = match source.relocation {
            SourceRelocation::Off => return Ok(None),
            SourceRelocation::Surface => 0.0,
            SourceRelocation::Clear => Self::CLEARANCE,
        };
        let overrides = [
            ("CLEARANCE", f64::from(clearance)),
            ("KEPT", f64::from(kept)),
            field.layout_constants()[0],
        ];
        let mut all = resources.to_vec();
        all.extend(field.state_resources());
        all.push(("probe_walks", source.walks.as_entire_binding()));
        let entry = |entry, overrides| -> Result<(Kernel, Bindings), GpuError> {
            let spec = KernelSpec {
                shader: "probes/source_walk",
                entry,
                offered: overrides,
                ..Default::default()
            };
            let kernel = Kernel::new(gpu, &spec)?;
            let bindings = kernel.bind(gpu, &all);
            Ok((kernel, bindings))
        };
        let begin = entry("begin", &overrides)?;
        let slots = field.volume().slots();
        Ok(Some(Self {
            groups: rectangle(slots.div_ceil(begin.0.workgroup_size[0])),
            begin,
            walk: entry("walk", &overrides)?,
            most: rectangle(slots),
            dispatch: field.dispatch().clone(),
        }))
    }

    /// After pass `probes/classify`.
    pub fn record_begin(&self, recorder: &mut Recorder<'_>) {
        recorder.run(&self.begin.0, &self.begin.1, self.groups);
    }

    /// After pass `probes/blend`.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        let active = (&self.dispatch, ProbeField::PROBES_OFFSET);
        recorder.run_indirect(&self.walk.0, &self.walk.1, self.most, active);
    }
}
