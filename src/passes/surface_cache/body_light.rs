//! Pass `surface_cache/body_light`: the indirect light of faces of bodies, which rays that hit bodies read.

use super::SurfaceCache;
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Offer, Recorder};

crate::shared! {
    in surface_cache;

    /// Most faces of bodies that send rays in a frame. Where there are more, bodies take turns.
    const MOST_FACES as MOST_BODY_FACES: u32 = 8192;

    /// Most faces whose columns send two rays each in a frame, four where there are half as many, and so on: as many as a workgroup
    /// has threads for.
    const FACES_OF_TWO as BODY_FACES_OF_TWO: u32 = 2048;

    /// Columns of a face, each with a voxel.
    const COLUMNS: u32 = 16;

    /// Threads of a workgroup, one for each ray.
    const THREADS as BODY_THREADS: u32 = 128;
}

pub struct BodyLight {
    kernel: Kernel,
    bindings: Bindings,
}

impl BodyLight {
    /// `offered`: the constants of the offer.
    pub fn spec<'a>(offered: &'a [(&'a str, f64)]) -> KernelSpec<'a> {
        KernelSpec {
            shader: "surface_cache/body_light",
            overrides: &[("COHERENT", 0.0), ("OF_MANY", 1.0)],
            offered,
            ..Default::default()
        }
    }

    /// `offer` is that of the scene, the probes and the surface cache.
    ///
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(gpu: &Gpu, faces: &SurfaceCache, offer: &Offer<'_>) -> Result<Self, GpuError> {
        let kernel = Kernel::new(gpu, &Self::spec(&offer.constants))?;
        Ok(Self {
            bindings: kernel.bind(gpu, &offer.with(faces.update_resources()).resources),
            kernel,
        })
    }

    /// In every frame, after pass `probes/cover`. Number of bodies, their faces with stored light, and most faces of one.
    pub fn record(&self, recorder: &mut Recorder<'_>, [bodies, faces, most]: [u32; 3]) {
        if faces == 0 {
            return;
        }
        let turns = faces.div_ceil(MOST_FACES);
        let rays = COLUMNS * rays_of_column(faces);
        let groups = most.div_ceil(THREADS / rays);
        recorder.run(
            &self.kernel,
            &self.bindings,
            [groups, bodies.div_ceil(turns)],
        );
    }
}

/// Rays that a column sends in a frame where there are so many faces: as in the shader.
fn rays_of_column(faces: u32) -> u32 {
    let share = (2 * FACES_OF_TWO / faces.max(1)).clamp(1, THREADS / COLUMNS);
    1 << share.ilog2()
}
