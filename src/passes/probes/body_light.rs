//! Pass `probes/body_light`: the indirect light of faces of bodies, which rays that hit bodies read.

use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Offer, Recorder};

crate::shared! {
    in probes;

    /// Most faces of bodies that send rays in a frame. Where there are more, bodies take turns.
    const MOST_FACES as MOST_BODY_FACES: u32 = 8192;

    /// Rays of a face in a frame, and faces of a workgroup. The thread of a ray also looks after one of the face's sixteen columns.
    const RAYS as BODY_RAYS: u32 = 16;
    const FACES_A_GROUP as BODY_FACES_A_GROUP: u32 = 4;
}

pub struct BodyLight {
    kernel: Kernel,
    bindings: Bindings,
}

impl BodyLight {
    /// `offered`: the constants of the offer.
    pub fn spec<'a>(offered: &'a [(&'a str, f64)]) -> KernelSpec<'a> {
        KernelSpec {
            shader: "probes/body_light",
            overrides: &[("COHERENT", 0.0), ("OF_MANY", 1.0)],
            offered,
            ..Default::default()
        }
    }

    /// `offer` is that of the scene and the probes.
    ///
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(gpu: &Gpu, offer: &Offer<'_>) -> Result<Self, GpuError> {
        let kernel = Kernel::new(gpu, &Self::spec(&offer.constants))?;
        Ok(Self {
            bindings: kernel.bind(gpu, &offer.resources),
            kernel,
        })
    }

    /// In every frame, after pass `probes/cover`. Number of bodies, their faces with stored light, and most faces of one.
    pub fn record(&self, recorder: &mut Recorder<'_>, [bodies, faces, most]: [u32; 3]) {
        if faces == 0 {
            return;
        }
        let turns = faces.div_ceil(MOST_FACES);
        let columns = most.div_ceil(FACES_A_GROUP);
        recorder.run(
            &self.kernel,
            &self.bindings,
            [columns, bodies.div_ceil(turns)],
        );
    }
}
