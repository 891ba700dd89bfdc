//! Pass `bench/shadow_count`: how many shadow rays a frame sends. Not part of a frame.

use crate::gpu::{Gpu, GpuError, Kernel, KernelSpec, Offer, Recorder, rectangle};

/// The parts of a frame that send shadow rays.
pub struct Senders<'a> {
    /// What the camera rays of the frame hit, as pass `view/camera_rays` wrote it.
    pub surfaces: &'a wgpu::Buffer,
    /// Width and height in pixels; `None`: the picture's own shadow rays are not counted.
    pub pixels: Option<[u32; 2]>,
    pub probe_rays: u32,
    /// Workgroups of pass `surface_cache/trace`, where there is a surface cache.
    pub face_groups: Option<[u32; 2]>,
}

/// Counts the shadow rays of the last frame. `offer` is that of the voxels, the view, the lights, the probes and the
/// surface cache.
///
/// # Errors
/// [`GpuError::Shader`]; [`GpuError::Device`] when the device is lost.
pub fn count(gpu: &Gpu, senders: &Senders<'_>, offer: &Offer<'_>) -> Result<u64, GpuError> {
    let counter = gpu.storage_buffer("shadow_count", 4)?;
    let all = offer.with([
        ("shaded_surfaces", senders.surfaces.as_entire_binding()),
        ("shadow_count", counter.as_entire_binding()),
    ]);
    let mut recorder = Recorder::new(gpu, None);
    let mut count = |entry, groups: &dyn Fn(&Kernel) -> [u32; 2]| -> Result<(), GpuError> {
        let spec = KernelSpec {
            shader: "bench/shadow_count",
            entry,
            offered: &offer.constants,
            ..Default::default()
        };
        let kernel = Kernel::new(gpu, &spec)?;
        recorder.run(&kernel, &kernel.bind(gpu, &all.resources), groups(&kernel));
        Ok(())
    };
    if let Some(size) = senders.pixels {
        count("pixels", &|kernel| kernel.groups_of(size))?;
    }
    count("probes", &|kernel| {
        rectangle(senders.probe_rays.div_ceil(kernel.workgroup_size[0]))
    })?;
    if let Some(groups) = senders.face_groups {
        count("faces", &|_| groups)?;
    }
    recorder.submit(gpu)?;
    let counted: Vec<u32> = gpu.read_buffer_range(&counter, 0, 4)?;
    Ok(counted.iter().map(|count| u64::from(*count)).sum())
}
