//! Pass `view/shade`: lights what the camera rays hit.

use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Offer, Recorder, rectangle};

/// The kernel and the picture that it writes.
pub struct Shade {
    kernel: Kernel,
    bindings: Bindings,
    /// `rgba16float`: linear HDR radiance (or the view's data), alpha 1; rows from the top.
    pub hdr: wgpu::Texture,
}

impl Shade {
    /// A picture of at most `size` pixels.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`] for a picture that no texture can hold.
    pub fn hdr(gpu: &Gpu, size: [u32; 2]) -> Result<wgpu::Texture, GpuError> {
        let format = wgpu::TextureFormat::Rgba16Float;
        gpu.texture("hdr", [size[0], size[1], 1], format)
    }

    /// `surfaces` is what the camera rays hit; `offer` is that of the scene, the probes and the surface cache.
    ///
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(
        gpu: &Gpu,
        hdr: wgpu::Texture,
        surfaces: &wgpu::Buffer,
        offer: &Offer<'_>,
    ) -> Result<Self, GpuError> {
        let kernel = Kernel::new(
            gpu,
            &KernelSpec {
                shader: "view/shade",
                offered: &offer.constants,
                ..Default::default()
            },
        )?;
        let hdr_view = hdr.create_view(&Default::default());
        let all = offer.with([
            ("surfaces", surfaces.as_entire_binding()),
            ("hdr", wgpu::BindingResource::TextureView(&hdr_view)),
        ]);
        Ok(Self {
            bindings: kernel.bind(gpu, &all.resources),
            kernel,
            hdr,
        })
    }

    /// `size` is that of the frame's view.
    pub fn record(&self, recorder: &mut Recorder<'_>, size: [u32; 2]) {
        let [columns, rows] = self.kernel.groups_of(size);
        recorder.run(&self.kernel, &self.bindings, rectangle(columns * rows));
    }
}
