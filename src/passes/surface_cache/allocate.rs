//! Pass `surface_cache/allocate`: lists the faces that the camera sees or rays have requested, and computes how many
//! workgroups it takes to light them.

use super::{
    SurfaceCache,
    shared::{CREW_WORDS, CREWS, REQUEST_ROOM},
};
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Offer, Recorder, rectangle};

pub struct SurfaceAllocate {
    kernel: Kernel,
    bindings: Bindings,
    groups: [u32; 2],
}

impl SurfaceAllocate {
    /// For pictures of `size` pixels. `surfaces` is what the camera rays hit; `scene` is the offer of the
    /// voxels, the lights, the bodies and the view, with the cells that pixels see.
    ///
    /// # Errors
    /// [`GpuError::Shader`], [`GpuError::TooLarge`].
    pub fn new(
        gpu: &Gpu,
        size: [u32; 2],
        surfaces: &wgpu::Buffer,
        faces: &SurfaceCache,
        scene: &Offer<'_>,
    ) -> Result<Self, GpuError> {
        let mut all = scene.resources.clone();
        all.extend(faces.update_resources());
        all.push(("surfaces", surfaces.as_entire_binding()));
        let crews = gpu.storage_buffer("finished_of_crew", u64::from(CREWS * CREW_WORDS) * 4)?;
        all.push(("finished_of_crew", crews.as_entire_binding()));
        let spec = KernelSpec {
            shader: "surface_cache/allocate",
            offered: &scene.constants,
            ..Default::default()
        };
        let kernel = Kernel::new(gpu, &spec)?;
        let bindings = kernel.bind(gpu, &all);
        // One thread per four pixels, and one for each face that rays may have requested.
        let [columns, rows] = kernel.groups_of(size.map(|pixels| pixels.div_ceil(2)));
        let threads: u32 = kernel.workgroup_size.iter().product();
        Ok(Self {
            kernel,
            bindings,
            groups: rectangle(columns * rows + REQUEST_ROOM / threads),
        })
    }

    /// After pass `view/camera_rays`, before pass `surface_cache/trace`.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        recorder.run(&self.kernel, &self.bindings, self.groups);
    }
}
