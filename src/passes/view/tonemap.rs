//! Pass `view/tonemap`: shows a picture in linear HDR that no other pass has shown.

use super::Display;
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Recorder};

pub struct Tonemap {
    kernel: Kernel,
    bindings: Bindings,
    size: [u32; 2],
}

impl Tonemap {
    /// `lit` is linear HDR of the display's size and any float format; `resources` are those of the view, whose exposure applies.
    ///
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(
        gpu: &Gpu,
        display: &Display,
        lit: &wgpu::Texture,
        resources: &[(&str, wgpu::BindingResource<'_>)],
    ) -> Result<Self, GpuError> {
        let kernel = Kernel::new(
            gpu,
            &KernelSpec {
                shader: "view/tonemap",
                ..Default::default()
            },
        )?;
        let lit = lit.create_view(&Default::default());
        let own = [("lit", wgpu::BindingResource::TextureView(&lit))];
        let all = [resources, &own, &display.resources()].concat();
        Ok(Self {
            bindings: kernel.bind(gpu, &all),
            kernel,
            size: [display.picture.width(), display.picture.height()],
        })
    }

    /// After the last pass that draws on the picture.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        let [width, height] = self.size;
        recorder.compute("view/tonemap", |pass| {
            self.kernel
                .dispatch_threads(pass, &self.bindings, [width, height, 1]);
        });
    }
}
