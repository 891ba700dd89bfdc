//! Pass `view/tonemap`: turns linear HDR into the 8-bit picture of files and windows.

use clap::ValueEnum as _;

use crate::{
    gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Recorder},
    measure::{picture::Picture, tonemap::curves},
    world::View,
};

/// The kernel and the picture that it writes.
pub struct Tonemap {
    kernel: Kernel,
    /// One for each picture that may be shown.
    bindings: Vec<Bindings>,
    /// `rgba8unorm`, sRGB-encoded, opaque.
    pub display: wgpu::Texture,
}

/// Format that the pass writes, and that readers sample or copy.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

impl Tonemap {
    /// For pictures of `size` pixels. `lit` are those that may be shown, in linear HDR of the same size and any float
    /// format; `resources` are those of the view, whose exposure and mode apply.
    ///
    /// # Errors
    /// [`GpuError::Shader`], [`GpuError::TooLarge`].
    pub fn new(
        gpu: &Gpu,
        size: [u32; 2],
        lit: &[wgpu::TextureView],
        resources: &[(&str, wgpu::BindingResource<'_>)],
    ) -> Result<Self, GpuError> {
        let data_modes = View::value_variants()
            .iter()
            .filter(|view| view.is_data())
            .fold(0u32, |bits, &view| bits | 1 << view as u32);
        let kernel = Kernel::new(
            gpu,
            &KernelSpec {
                shader: "view/tonemap",
                overrides: &[("data_modes", f64::from(data_modes))],
                ..Default::default()
            },
        )?;
        let display = gpu.texture("display", [size[0], size[1], 1], FORMAT)?;
        let display_view = display.create_view(&Default::default());
        let tone_curves = gpu.storage_buffer_of("tone_curves", &curves())?;
        let bind = |lit| {
            let mut all = resources.to_vec();
            all.push(("tone_curves", tone_curves.as_entire_binding()));
            all.push(("lit", wgpu::BindingResource::TextureView(lit)));
            all.push((
                "display_out",
                wgpu::BindingResource::TextureView(&display_view),
            ));
            kernel.bind(gpu, &all)
        };
        Ok(Self {
            bindings: lit.iter().map(bind).collect(),
            kernel,
            display,
        })
    }

    /// Shows the picture of this index.
    ///
    /// # Panics
    /// If there is none: that is a caller's bug.
    pub fn record(&self, recorder: &mut Recorder<'_>, which: usize) {
        recorder.compute("view/tonemap", |pass| {
            let size = [self.display.width(), self.display.height(), 1];
            self.kernel
                .dispatch_threads(pass, &self.bindings[which], size);
        });
    }

    /// Reads the picture back as display values.
    ///
    /// # Errors
    /// [`GpuError::Device`] when the device is lost.
    pub fn read_back(&self, gpu: &Gpu) -> Result<Picture, GpuError> {
        let texels: Vec<[u8; 4]> = gpu.read_texture(&self.display)?;
        let rgb = |[r, g, b, _]: [u8; 4]| [r, g, b].map(|value| f32::from(value) / 255.0);
        Ok(Picture {
            width: self.display.width(),
            height: self.display.height(),
            rgb: texels.into_iter().map(rgb).collect(),
        })
    }
}
