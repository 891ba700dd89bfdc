//! Pass `scene/publish_facts`: hands what passes have found out about bodies to all others.

use super::GpuBodies;
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Recorder, rectangle};

/// A pass and no copy: copies wait for all passes before them, and all after them wait for the copies.
pub struct PublishFacts {
    kernel: Kernel,
    bindings: Bindings,
    groups: [u32; 2],
}

impl PublishFacts {
    pub fn spec() -> KernelSpec<'static> {
        KernelSpec {
            shader: "scene/publish_facts",
            ..Default::default()
        }
    }

    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(gpu: &Gpu, bodies: &GpuBodies) -> Result<Self, GpuError> {
        let kernel = Kernel::new(gpu, &Self::spec())?;
        let groups = bodies.fact_vectors().div_ceil(kernel.workgroup_size[0]);
        Ok(Self {
            bindings: kernel.bind(gpu, &bodies.resources_to_publish()),
            kernel,
            groups: rectangle(groups),
        })
    }

    /// After the passes that find something out, before those that read it.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        recorder.run(&self.kernel, &self.bindings, self.groups);
    }
}
