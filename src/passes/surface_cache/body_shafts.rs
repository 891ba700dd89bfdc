//! Pass `surface_cache/body_shafts`: which lamps bodies may hide from each cell of the world and from each other.

use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Offer, Recorder, rectangle};

pub struct BodyShafts {
    kernel: Kernel,
    bindings: Bindings,
}

impl BodyShafts {
    /// `offered`: the constants of the offer.
    pub fn spec<'a>(offered: &'a [(&'a str, f64)]) -> KernelSpec<'a> {
        KernelSpec {
            shader: "surface_cache/body_shafts",
            offered,
            ..Default::default()
        }
    }

    /// `scene` is the offer of the voxels, the lights and the bodies.
    ///
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(gpu: &Gpu, scene: &Offer<'_>) -> Result<Self, GpuError> {
        let kernel = Kernel::new(gpu, &Self::spec(&scene.constants))?;
        Ok(Self {
            bindings: kernel.bind(gpu, &scene.resources),
            kernel,
        })
    }

    /// In frames in which a body or a lamp has moved, after pass `scene/lamp_lists`. `places`: cells and bodies.
    pub fn record(&self, recorder: &mut Recorder<'_>, places: u32) {
        recorder.run(&self.kernel, &self.bindings, rectangle(places));
    }
}
