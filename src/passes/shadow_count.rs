//! Pass `shadow_count`: how many shadow rays a frame sends. Not part of a frame.

use super::ProbeField;
use crate::gpu::{Gpu, GpuError, Kernel, KernelSpec, Recorder, rectangle};

/// Counts the shadow rays of the last frame: those of its probe rays, and with `pixels` those of a
/// picture of `size` pixels. `resources` are those of the voxels, the view and the lights.
///
/// # Errors
/// [`GpuError::Shader`]; [`GpuError::Device`] when the device is lost.
pub fn count(
    gpu: &Gpu,
    field: &ProbeField,
    surfaces: &wgpu::Buffer,
    size: [u32; 2],
    pixels: bool,
    resources: &[(&str, wgpu::BindingResource<'_>)],
) -> Result<u64, GpuError> {
    let counter = gpu.storage_buffer("shadow_count", 4)?;
    let mut all = resources.to_vec();
    all.extend(field.resources());
    all.push(("shaded_surfaces", surfaces.as_entire_binding()));
    all.push(("shadow_count", counter.as_entire_binding()));
    let kernel = |entry| {
        Kernel::new(
            gpu,
            &KernelSpec {
                shader: "passes/shadow_count",
                entry,
                ..Default::default()
            },
        )
    };
    let mut recorder = Recorder::new(gpu, None);
    if pixels {
        let kernel = kernel("pixels")?;
        let bindings = kernel.bind(gpu, &all);
        recorder.run(&kernel, &bindings, kernel.groups_of(size));
    }
    let kernel = kernel("probes")?;
    let bindings = kernel.bind(gpu, &all);
    let rays = field.atlas().slots * field.rays_per_probe();
    let groups = rays.div_ceil(kernel.workgroup_size[0]);
    recorder.run(&kernel, &bindings, rectangle(groups));
    recorder.submit(gpu)?;
    let counted: Vec<u32> = gpu.read_buffer_range(&counter, 0, 4)?;
    Ok(counted.iter().map(|count| u64::from(*count)).sum())
}
