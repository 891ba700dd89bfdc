//! The 8-bit picture of files and windows, which the pass that finishes a picture writes (`shaders/view/display.wesl`).

use crate::{
    gpu::{Gpu, GpuError},
    measure::{picture::Picture, tonemap::curves},
};

/// The picture, and what passes need that write it. A clone is the same picture.
#[derive(Clone)]
pub struct Display {
    /// `rgba8unorm`, sRGB-encoded, opaque.
    pub picture: wgpu::Texture,
    view: wgpu::TextureView,
    tone_curves: wgpu::Buffer,
}

impl Display {
    /// Format that passes write, and that readers sample or copy.
    const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

    /// For pictures of `size` pixels.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`].
    pub fn new(gpu: &Gpu, size: [u32; 2]) -> Result<Self, GpuError> {
        let picture = gpu.texture("display", [size[0], size[1], 1], Self::FORMAT)?;
        Ok(Self {
            view: picture.create_view(&Default::default()),
            picture,
            tone_curves: gpu.storage_buffer_of("tone_curves", &curves())?,
        })
    }

    /// What these passes bind.
    pub fn resources(&self) -> [(&'static str, wgpu::BindingResource<'_>); 2] {
        [
            ("tone_curves", self.tone_curves.as_entire_binding()),
            (
                "display_out",
                wgpu::BindingResource::TextureView(&self.view),
            ),
        ]
    }

    /// Reads the picture back as display values.
    ///
    /// # Errors
    /// [`GpuError::Device`] when the device is lost.
    pub fn read_back(&self, gpu: &Gpu) -> Result<Picture, GpuError> {
        let texels: Vec<[u8; 4]> = gpu.read_texture(&self.picture)?;
        let rgb = |[r, g, b, _]: [u8; 4]| [r, g, b].map(|value| f32::from(value) / 255.0);
        Ok(Picture {
            width: self.picture.width(),
            height: self.picture.height(),
            rgb: texels.into_iter().map(rgb).collect(),
        })
    }
}
