//! Pass `view/bits`: small cubes in the picture that are no voxels: what flies off a dug voxel, and the bulbs of
//! lamps. The light of the probes and of the lamps falls on them; they cast no shadow and light nothing.

use crate::{
    gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Offer, Recorder, rectangle},
    world::{View, placed::MOST_PLACED},
};

crate::shared! {
    in view;

    /// A cube along the axes, in world space (voxels).
    pub struct GpuBit as Bit {
        pub centre_ws: [f32; 3],
        /// From its centre to its faces.
        pub half_size: f32,
        /// Linear RGB.
        pub albedo: [f32; 3],
        /// 1: it flies, and leaves no history to the next picture. 0: it stands still.
        pub flies: u32,
        /// Radiance (linear RGB).
        pub emission: [f32; 3],
        pub _pad: u32,
    }

    /// Faces of a bit.
    const BIT_FACES: u32 = 6;

    /// Bits that a workgroup looks at together: one for each thread.
    const BIT_BATCH: u32 = 64;
}

/// The kernels, and the bits of the next picture.
pub struct Bits {
    light: (Kernel, Bindings),
    draw: (Kernel, Bindings),
    bits: wgpu::Buffer,
    /// A buffer, not a uniform: see `per_thread` in shaders/math/per_thread.wesl.
    bit_count: wgpu::Buffer,
    lights: wgpu::Buffer,
    count: u32,
}

impl Bits {
    /// Most bits in a picture: the bulbs of all lamps that can be placed, and some that fly.
    pub const MOST: usize = MOST_PLACED + 256;

    /// Draws over `hdr` (`rgba16float`), a picture of `surfaces`. `offer` is that of the scene and the probes.
    ///
    /// # Errors
    /// [`GpuError::Shader`], [`GpuError::TooLarge`].
    pub fn new(
        gpu: &Gpu,
        hdr: &wgpu::Texture,
        surfaces: &wgpu::Buffer,
        offer: &Offer<'_>,
    ) -> Result<Self, GpuError> {
        let most = Self::MOST as u64;
        let bits = gpu.storage_buffer("bits", most * size_of::<GpuBit>() as u64)?;
        let bit_count = gpu.storage_buffer("bit_count", size_of::<u32>() as u64)?;
        let of_a_face = size_of::<[f32; 4]>() as u64;
        let lights = gpu.storage_buffer("bit_lights", most * u64::from(BIT_FACES) * of_a_face)?;
        let hdr_view = hdr.create_view(&Default::default());
        let all = offer.with([
            ("bits", bits.as_entire_binding()),
            ("bit_count", bit_count.as_entire_binding()),
            ("bit_lights_out", lights.as_entire_binding()),
            ("bit_lights", lights.as_entire_binding()),
            ("surfaces", surfaces.as_entire_binding()),
            ("hdr", wgpu::BindingResource::TextureView(&hdr_view)),
        ]);
        let bound = |entry| {
            let spec = KernelSpec {
                shader: "view/bits",
                entry,
                overrides: &[("FREE_AIR", 1.0)],
                offered: &offer.constants,
                ..Default::default()
            };
            let kernel = Kernel::new(gpu, &spec)?;
            let bindings = kernel.bind(gpu, &all.resources);
            Ok::<_, GpuError>((kernel, bindings))
        };
        Ok(Self {
            light: bound("light")?,
            draw: bound("draw")?,
            bits,
            bit_count,
            lights,
            count: 0,
        })
    }

    /// Whether bits are drawn in this view. Views of data and of parts of the light show voxels alone.
    pub fn are_in(view: View) -> bool {
        matches!(view, View::Full | View::TexturesOff)
    }

    /// Sets the bits of the next pictures: the first [`Self::MOST`] of these.
    pub fn set(&mut self, gpu: &Gpu, bits: &[GpuBit]) {
        let bits = &bits[..bits.len().min(Self::MOST)];
        self.count = bits.len() as u32;
        if self.count > 0 {
            let bytes = bytemuck::cast_slice(bits);
            gpu.queue.write_buffer(&self.bits, 0, bytes);
            let count = bytemuck::bytes_of(&self.count);
            gpu.queue.write_buffer(&self.bit_count, 0, count);
        }
    }

    /// After pass `view/shade`, for a view of `size` pixels. Without bits nothing is recorded.
    pub fn record(&self, recorder: &mut Recorder<'_>, size: [u32; 2]) {
        if self.count > 0 {
            let groups = (self.count * BIT_FACES).div_ceil(self.light.0.workgroup_size[0]);
            recorder.run(&self.light.0, &self.light.1, rectangle(groups));
            let [columns, rows] = self.draw.0.groups_of(size);
            recorder.run(&self.draw.0, &self.draw.1, rectangle(columns * rows));
        }
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        self.bits.size() + self.bit_count.size() + self.lights.size()
    }
}
