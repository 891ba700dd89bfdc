//! Pass `view/atlas_view`: one layer of an atlas, flat, in place of the picture.

use bytemuck::{Pod, Zeroable};

use super::AtlasLayer;
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Offer, Recorder};

/// `AtlasJob` of `shaders/view/atlas_view.wesl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct GpuAtlasJob {
    pub layer: u32,
    pub map: u32,
    pub extent: [u32; 2],
}

pub struct AtlasView {
    kernel: Kernel,
    bindings: Bindings,
    groups: [u32; 2],
}

impl AtlasView {
    /// Over `hdr` (`rgba16float`). The layer must be one of the field's (see [`AtlasLayer::check`]);
    /// `resources` are those of the view.
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
