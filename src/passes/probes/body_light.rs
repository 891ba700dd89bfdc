//! Pass `probes/body_light`: the indirect light of faces of bodies, which rays that hit bodies read.

use crate::{
    gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Offer, Recorder, rectangle},
    passes::scene::GpuBodies,
};

pub struct BodyLight {
    kernel: Kernel,
    bindings: Bindings,
    bodies: GpuBodies,
}

impl BodyLight {
    /// `offer` is that of the scene and the probes.
    ///
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(gpu: &Gpu, bodies: &GpuBodies, offer: &Offer<'_>) -> Result<Self, GpuError> {
        let kernel = Kernel::new(
            gpu,
            &KernelSpec {
                shader: "probes/body_light",
                offered: &offer.constants,
                ..Default::default()
            },
        )?;
        let all = offer.with([bodies.facts()]);
        Ok(Self {
            bindings: kernel.bind(gpu, &all.resources),
            kernel,
            bodies: bodies.clone(),
        })
    }

    /// In every frame, after pass `probes/cover`. [`GpuBodies::publish_facts`] hands over the result.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        let faces = self.bodies.lit_faces().min(MOST_FACES);
        if faces == 0 {
            return;
        }
        let groups = rectangle(faces.div_ceil(self.kernel.workgroup_size[0]));
        recorder.run(&self.kernel, &self.bindings, groups);
    }
}

crate::shared! {
    in probes;

    /// Most faces of bodies that find their light in a frame. Where there are more, they take turns.
    const MOST_FACES as MOST_BODY_FACES: u32 = 65536;
}
