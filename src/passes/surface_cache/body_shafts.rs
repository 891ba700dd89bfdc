//! Pass `surface_cache/body_shafts`: which lamps bodies may hide from each cell of the world.

use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Offer, Recorder, rectangle};

pub struct BodyShafts {
    kernel: Kernel,
    bindings: Bindings,
    groups: [u32; 2],
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

    /// For this many cells. `scene` is the offer of the voxels, the lights and the bodies.
    ///
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(gpu: &Gpu, cells: u32, scene: &Offer<'_>) -> Result<Self, GpuError> {
        let kernel = Kernel::new(gpu, &Self::spec(&scene.constants))?;
        Ok(Self {
            bindings: kernel.bind(gpu, &scene.resources),
            kernel,
            groups: rectangle(cells),
        })
    }

    /// In frames in which a body or a lamp has moved, after pass `scene/lamp_lists`.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        recorder.run(&self.kernel, &self.bindings, self.groups);
    }
}
