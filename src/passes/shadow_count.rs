//! Pass `shadow_count`: how many shadow rays a frame sends. Not part of a frame.

use super::{FaceTable, ProbeField};
use crate::gpu::{Gpu, GpuError, Kernel, KernelSpec, Recorder, rectangle};

/// Counts the shadow rays of the last frame: those of its probe rays and of the rays of its faces, and with
/// `pixels` those of a picture of `size` pixels. `resources` are those of the voxels, the view and the lights.
///
/// # Errors
/// [`GpuError::Shader`]; [`GpuError::Device`] when the device is lost.
pub fn count(
    gpu: &Gpu,
    field: &ProbeField,
    faces: &FaceTable,
    surfaces: &wgpu::Buffer,
    size: [u32; 2],
    pixels: bool,
    resources: &[(&str, wgpu::BindingResource<'_>)],
) -> Result<u64, GpuError> {
    let counter = gpu.storage_buffer("shadow_count", 4)?;
    let mut all = resources.to_vec();
    all.extend(field.resources());
    all.extend(faces.update_resources());
    all.push(("shaded_surfaces", surfaces.as_entire_binding()));
    all.push(("shadow_count", counter.as_entire_binding()));
    let mut recorder = Recorder::new(gpu, None);
    let mut count = |entry, groups: &dyn Fn(&Kernel) -> [u32; 2]| -> Result<(), GpuError> {
        let spec = KernelSpec {
            shader: "passes/shadow_count",
            entry,
            ..Default::default()
        };
        let kernel = Kernel::new(gpu, &spec)?;
        recorder.run(&kernel, &kernel.bind(gpu, &all), groups(&kernel));
        Ok(())
    };
    if pixels {
        count("pixels", &|kernel| kernel.groups_of(size))?;
    }
    let rays = field.atlas().slots * field.rays_per_probe();
    count("probes", &|kernel| {
        rectangle(rays.div_ceil(kernel.workgroup_size[0]))
    })?;
    if faces.is_used() {
        count("faces", &|_| faces.rays_most(size))?;
    }
    recorder.submit(gpu)?;
    let counted: Vec<u32> = gpu.read_buffer_range(&counter, 0, 4)?;
    Ok(counted.iter().map(|count| u64::from(*count)).sum())
}
