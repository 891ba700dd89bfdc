//! Pass `view/camera_rays`: traces one ray through each pixel's centre and stores what the ray hits.

use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Offer, Recorder};

/// The kernel and the surfaces that it writes: 8 bytes per pixel, rows from the top
/// (`shaders/march/surface.wesl` says how to read them).
pub struct CameraRays {
    kernel: Kernel,
    bindings: Bindings,
    pub surfaces: wgpu::Buffer,
}

impl CameraRays {
    /// Bytes per pixel of the largest buffer of a picture.
    pub const BYTES_PER_PIXEL: u64 = 8;

    /// The surfaces of pictures of at most `size` pixels.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`].
    pub fn surfaces(gpu: &Gpu, size: [u32; 2]) -> Result<wgpu::Buffer, GpuError> {
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        gpu.storage_buffer("surfaces", pixels * Self::BYTES_PER_PIXEL)
    }

    /// `scene` is the offer of the voxels, the bodies and the view.
    ///
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(gpu: &Gpu, surfaces: wgpu::Buffer, scene: &Offer<'_>) -> Result<Self, GpuError> {
        let kernel = Kernel::new(
            gpu,
            &KernelSpec {
                shader: "view/camera_rays",
                offered: &scene.constants,
                ..Default::default()
            },
        )?;
        let all = scene.with([("surfaces_out", surfaces.as_entire_binding())]);
        Ok(Self {
            bindings: kernel.bind(gpu, &all.resources),
            kernel,
            surfaces,
        })
    }

    /// `size` is that of the frame's view.
    pub fn record(&self, recorder: &mut Recorder<'_>, size: [u32; 2]) {
        let groups = self.kernel.groups_of(size);
        recorder.run(&self.kernel, &self.bindings, groups);
    }
}
