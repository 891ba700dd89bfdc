//! Pass `scene/body_shafts`: which lamps bodies may hide from each cell of the world.

use super::GpuBodies;
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Offer, Recorder, rectangle};

pub struct BodyShafts {
    kernel: Kernel,
    bindings: Bindings,
    groups: [u32; 2],
}

impl BodyShafts {
    /// `scene` is the offer of the voxels, the lights and the bodies.
    ///
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(gpu: &Gpu, bodies: &GpuBodies, scene: &Offer<'_>) -> Result<Self, GpuError> {
        let kernel = Kernel::new(
            gpu,
            &KernelSpec {
                shader: "scene/body_shafts",
                offered: &scene.constants,
                ..Default::default()
            },
        )?;
        let all = scene.with([bodies.facts()]);
        Ok(Self {
            bindings: kernel.bind(gpu, &all.resources),
            kernel,
            groups: rectangle(bodies.cells()),
        })
    }

    /// In frames in which a body or a lamp has moved, after pass `scene/lamp_lists`.
    /// [`GpuBodies::publish_facts`] hands over the result.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        recorder.run(&self.kernel, &self.bindings, self.groups);
    }
}
