//! Pass `probes/body_light`: the indirect light of faces of bodies, which rays that hit bodies read.

use crate::{
    gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Offer, Recorder, rectangle},
    passes::scene::GpuBodies,
};

pub struct BodyLight {
    kernel: Kernel,
    bindings: Bindings,
    groups: [u32; 2],
}

impl BodyLight {
    /// `offer` is that of the scene and the probes; `None` where there are no bodies.
    ///
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(gpu: &Gpu, bodies: &GpuBodies, offer: &Offer<'_>) -> Result<Option<Self>, GpuError> {
        if !bodies.exist() {
            return Ok(None);
        }
        let kernel = Kernel::new(
            gpu,
            &KernelSpec {
                shader: "probes/body_light",
                offered: &offer.constants,
                ..Default::default()
            },
        )?;
        let all = offer.with([bodies.facts()]);
        let faces = bodies.lit_faces().min(MOST_FACES);
        Ok(Some(Self {
            bindings: kernel.bind(gpu, &all.resources),
            groups: rectangle(faces.div_ceil(kernel.workgroup_size[0])),
            kernel,
        }))
    }

    /// In every frame, after pass `probes/cover`. [`GpuBodies::publish_facts`] hands over the result.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        recorder.run(&self.kernel, &self.bindings, self.groups);
    }
}

crate::shared! {
    in probes;

    /// Most faces of bodies that find their light in a frame. Where there are more, they take turns.
    const MOST_FACES as MOST_BODY_FACES: u32 = 65536;
}
