//! Pass `view/atlas_view`: one layer of an atlas, flat, in place of the picture.

use super::AtlasLayer;
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Offer, Recorder};

crate::shared! {
    in view;

    /// The part of an atlas that is shown.
    pub struct GpuAtlasJob as AtlasJob {
        pub layer: u32,
        /// One of the MAP_ constants.
        pub map: u32,
        /// Width and height of the layer in texels.
        pub extent: [u32; 2],
    }
}

pub struct AtlasView {
    kernel: Kernel,
    bindings: Bindings,
    groups: [u32; 2],
}

impl AtlasView {
    /// Draws over `hdr` (`rgba16float`). The layer must exist in the field (see [`AtlasLayer::check`]); `offer` is that
    /// of the view and the probes.
    ///
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(
        gpu: &Gpu,
        shown: AtlasLayer,
        hdr: &wgpu::Texture,
        extent: [u32; 2],
        offer: &Offer<'_>,
    ) -> Result<Self, GpuError> {
        let kernel = Kernel::new(
            gpu,
            &KernelSpec {
                shader: "view/atlas_view",
                ..Default::default()
            },
        )?;
        let job = GpuAtlasJob {
            layer: shown.layer,
            map: shown.map as u32,
            extent,
        };
        let job = gpu.uniform_buffer("atlas_job", &job);
        let hdr_view = hdr.create_view(&Default::default());
        let all = offer.with([
            ("atlas_job", job.as_entire_binding()),
            ("hdr", wgpu::BindingResource::TextureView(&hdr_view)),
        ]);
        Ok(Self {
            bindings: kernel.bind(gpu, &all.resources),
            groups: kernel.groups_of([hdr.width(), hdr.height()]),
            kernel,
        })
    }

    /// After pass `view/shade`, before pass `view/tonemap`.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        recorder.run(&self.kernel, &self.bindings, self.groups);
    }
}
