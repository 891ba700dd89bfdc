//! The picture of a frame, on the GPU and read back.

use super::Frame;
use crate::{
    gpu::{Gpu, GpuError},
    measure::picture::Picture,
};

impl Frame {
    /// The picture after tone mapping: `rgba8unorm`, sRGB-encoded.
    pub fn display(&self) -> &wgpu::Texture {
        &self.passes.display.picture
    }

    /// The picture after tone mapping, as display values in [0, 1].
    ///
    /// # Errors
    /// [`GpuError::Device`] when the device is lost.
    pub fn read_display(&self, gpu: &Gpu) -> Result<Picture, GpuError> {
        self.passes.display.read_back(gpu)
    }

    /// The linear radiance before tone mapping, after anti-aliasing.
    ///
    /// # Errors
    /// [`GpuError::Device`] when the device is lost.
    pub fn read_radiance(&self, gpu: &Gpu) -> Result<Picture, GpuError> {
        let texels: Vec<[half::f16; 4]> =
            gpu.read_texture(self.passes.radiance(self.drawn.smoothed))?;
        Ok(Picture {
            width: self.size[0],
            height: self.size[1],
            rgb: texels
                .iter()
                .map(|[r, g, b, _]| [r.to_f32(), g.to_f32(), b.to_f32()])
                .collect(),
        })
    }
}
