//! Pass `probes/cover`: which probes bodies cover, and which may see them. Needed when bodies have moved, and after pass
//! `probes/classify`.

use super::ProbeField;
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Offer, Recorder, rectangle};

pub struct ProbeCover {
    kernel: Kernel,
    bindings: Bindings,
    groups: [u32; 2],
}

impl ProbeCover {
    /// `offered`: the constants of the offer.
    pub fn spec<'a>(offered: &'a [(&'a str, f64)]) -> KernelSpec<'a> {
        KernelSpec {
            shader: "probes/cover",
            offered,
            ..Default::default()
        }
    }

    /// `offer` is that of the scene and the probes.
    ///
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(gpu: &Gpu, field: &ProbeField, offer: &Offer<'_>) -> Result<Self, GpuError> {
        let kernel = Kernel::new(gpu, &Self::spec(&offer.constants))?;
        let all = offer.with(field.cover_resources());
        let groups = field.atlas().slots.div_ceil(kernel.workgroup_size[0]);
        Ok(Self {
            bindings: kernel.bind(gpu, &all.resources),
            kernel,
            groups: rectangle(groups),
        })
    }

    /// Before pass `probes/schedule`.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        recorder.run(&self.kernel, &self.bindings, self.groups);
    }
}
