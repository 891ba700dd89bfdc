//! Pass `surface_cache/allocate`: lists the faces that the camera sees or rays have requested, and computes how many
//! workgroups it takes to light them.

use super::{
    SurfaceCache,
    shared::{REQUEST_ROOM, REQUESTS_A_GROUP},
};
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Offer, Recorder, rectangle};

/// Workgroups for all faces that rays may have requested.
const REQUEST_GROUPS: u32 = REQUEST_ROOM / REQUESTS_A_GROUP;

pub struct SurfaceAllocate {
    seen: (Kernel, Bindings),
    requested: (Kernel, Bindings),
    groups: [u32; 2],
}

impl SurfaceAllocate {
    /// For pictures of `size` pixels. `surfaces` is what the camera rays hit; `scene` is the offer of the
    /// voxels, the lights, the bodies and the view, with the cells that pixels see.
    ///
    /// # Errors
    /// [`GpuError::Shader`].
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
        let spec = KernelSpec {
            shader: "surface_cache/allocate",
            offered: &scene.constants,
            ..Default::default()
        };
        let entries = ["allocate_seen", "allocate_requested"];
        let kernels = Kernel::of_entries(gpu, &spec, entries)?;
        let [seen, requested] = kernels.map(|kernel| {
            let bindings = kernel.bind(gpu, &all);
            (kernel, bindings)
        });
        // One thread per four pixels.
        let [columns, rows] = seen.0.groups_of(size.map(|pixels| pixels.div_ceil(2)));
        Ok(Self {
            seen,
            requested,
            groups: rectangle(columns * rows),
        })
    }

    /// After pass `view/camera_rays`.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        let (kernel, bindings) = &self.seen;
        recorder.run(kernel, bindings, self.groups);
    }

    /// Lists the faces that rays have requested, then computes the work in all. After
    /// [`record`](Self::record), before pass `surface_cache/trace`.
    pub fn record_requested(&self, recorder: &mut Recorder<'_>) {
        let (kernel, bindings) = &self.requested;
        recorder.compute(&kernel.label, |pass| {
            kernel.dispatch(pass, bindings, [REQUEST_GROUPS, 1, 1]);
        });
    }
}
