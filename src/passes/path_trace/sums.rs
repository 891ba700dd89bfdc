//! What the path tracer stores for each pixel.

use crate::{
    gpu::{Gpu, GpuError, Recorder},
    measure::picture::Picture,
};

/// The buffers of a picture.
pub struct Sums {
    /// RGB: the light that is not random.
    certain: wgpu::Buffer,
    /// RGB: sum of the samples that `totals` does not hold yet; A: their number.
    sums: wgpu::Buffer,
    totals: wgpu::Buffer,
    size: [u32; 2],
}

impl Sums {
    /// Bytes of each of the three buffers.
    pub const BYTES_PER_PIXEL: u64 = 16;

    /// # Errors
    /// [`GpuError::TooLarge`].
    pub fn new(gpu: &Gpu, size: [u32; 2]) -> Result<Self, GpuError> {
        let buffer = |label| gpu.storage_buffer(label, bytes(size));
        Ok(Self {
            certain: buffer("certain")?,
            sums: buffer("sums")?,
            totals: buffer("totals")?,
            size,
        })
    }

    /// What the shaders bind by name.
    pub fn resources(&self) -> [(&'static str, wgpu::BindingResource<'_>); 3] {
        [
            ("certain", self.certain.as_entire_binding()),
            ("sums", self.sums.as_entire_binding()),
            ("totals", self.totals.as_entire_binding()),
        ]
    }

    /// Forgets all samples, and keeps the light that is not random.
    pub fn clear(&self, recorder: &mut Recorder<'_>) {
        for buffer in [&self.sums, &self.totals] {
            recorder.encoder.clear_buffer(buffer, 0, None);
        }
    }

    /// The light that is not random: linear radiance, or the view's data (depth in voxels).
    ///
    /// # Errors
    /// [`GpuError::Device`] when the device is lost.
    pub fn read_certain(&self, gpu: &Gpu) -> Result<Picture, GpuError> {
        let [width, height] = self.size;
        let certain = self.read_buffer(gpu, &self.certain)?;
        Ok(Picture {
            width,
            height,
            rgb: certain.iter().map(|[r, g, b, _]| [*r, *g, *b]).collect(),
        })
    }

    /// The sum of each pixel's samples since [`clear`](Self::clear), and the number of samples. `samples` is the
    /// expected number.
    ///
    /// # Errors
    /// [`GpuError::Device`] when the device is lost.
    pub fn read(&self, gpu: &Gpu, samples: u32) -> Result<Vec<[f32; 4]>, GpuError> {
        let mut sums = self.read_buffer(gpu, &self.sums)?;
        if sums.iter().any(|sum| sum[3] != samples as f32) {
            // The others are in the totals.
            for (sum, total) in sums.iter_mut().zip(self.read_buffer(gpu, &self.totals)?) {
                *sum = std::array::from_fn(|channel| total[channel] + sum[channel]);
            }
        }
        Ok(sums)
    }

    fn read_buffer(&self, gpu: &Gpu, buffer: &wgpu::Buffer) -> Result<Vec<[f32; 4]>, GpuError> {
        gpu.read_buffer_range(buffer, 0, bytes(self.size))
    }
}

fn bytes(size: [u32; 2]) -> u64 {
    u64::from(size[0]) * u64::from(size[1]) * Sums::BYTES_PER_PIXEL
}
