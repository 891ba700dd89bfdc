//! Pass `view/antialias`: temporal anti-aliasing of what was shaded. It shows the picture as well.

use super::Display;
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Offer, Recorder};

crate::shared! {
    in view;

    /// The last picture's camera, and how much of that picture is kept.
    pub struct GpuHistory as History {
        /// The last camera, without jitter, as in the frame's view.
        pub position_ws: [f32; 3],
        /// 1: history is clipped to the neighbours of its pixel.
        pub clips: u32,
        pub forward_ws: [f32; 3],
        /// Most rays that a pixel averages.
        pub most_samples: f32,
        pub right_ws: [f32; 3],
        /// 1: there is no history.
        pub forgets: u32,
        pub up_ws: [f32; 3],
        /// 1: the camera has moved since the last picture.
        pub moved: u32,
        /// First voxel (grid space) of the box that was edited since the last picture.
        pub edited_first: [u32; 3],
        /// 1: bodies have moved since the last picture.
        pub bodies_moved: u32,
        /// Last voxel of that box; before the first one where nothing was edited.
        pub edited_last: [u32; 3],
        /// 1: voxels were edited since the last picture.
        pub edited: u32,
        /// Where this frame's rays go through their pixels: pixels from the centre.
        pub jitter: [f32; 2],
        /// Width and height of the shown picture in pixels. The frame's view has those of the rendered one.
        pub size: [u32; 2],
    }

    /// Alpha of a picture is this plus the number of rays in it: tone mapping must not take a number for one of
    /// its marks (SHOWN_AS_ in shaders/frame/view.wesl).
    const COUNT_BASE: f32 = 3.0;
}

/// The kernel and the pictures that it averages.
///
/// Per pixel the pass reads 8 bytes of the picture, 8 of its surface, and as many of the history, and writes 16: 48
/// bytes, besides neighbours, which are in the cache. It holds 32 bytes per pixel.
pub struct TemporalAntialias {
    kernel: Kernel,
    /// For each picture that may be written.
    bindings: [Bindings; 2],
    uniform: wgpu::Buffer,
    /// `rgba16float`: linear HDR radiance. Each is history of the other.
    pub colours: [wgpu::Texture; 2],
    size: [u32; 2],
}

impl TemporalAntialias {
    /// Bytes of GPU memory per pixel: two pictures and their surfaces.
    pub const BYTES_PER_PIXEL: u64 = 2 * (8 + 8);

    /// For pictures of the size of `display`, where they are shown. `lit` is this frame's radiance and `surfaces` what its camera rays hit. Both have
    /// room for all pixels; with `upscales` the frame's view may say that fewer are rendered. `offer` is that of the voxels and
    /// the view.
    ///
    /// # Errors
    /// [`GpuError::Shader`], [`GpuError::TooLarge`].
    pub fn new(
        gpu: &Gpu,
        display: &Display,
        lit: &wgpu::Texture,
        surfaces: &wgpu::Buffer,
        upscales: bool,
        offer: &Offer<'_>,
    ) -> Result<Self, GpuError> {
        let kernel = Kernel::new(
            gpu,
            &KernelSpec {
                shader: "view/antialias",
                overrides: &[("upscales", f64::from(u8::from(upscales)))],
                offered: &offer.constants,
                ..Default::default()
            },
        )?;
        let size = [display.picture.width(), display.picture.height()];
        let colour = || {
            let format = wgpu::TextureFormat::Rgba16Float;
            gpu.texture("antialiased", [size[0], size[1], 1], format)
        };
        let colours = [colour()?, colour()?];
        let kept = || gpu.storage_buffer("surfaces_of_history", surfaces.size());
        let kept = [kept()?, kept()?];
        let uniform = gpu.uniform_buffer("history", &GpuHistory::default());
        let views = colours
            .each_ref()
            .map(|texture| texture.create_view(&Default::default()));
        let lit = lit.create_view(&Default::default());
        let bindings = [0, 1].map(|which| {
            let own = [
                ("history", uniform.as_entire_binding()),
                ("surfaces", surfaces.as_entire_binding()),
                ("lit", wgpu::BindingResource::TextureView(&lit)),
                ("surfaces_before", kept[1 - which].as_entire_binding()),
                (
                    "colours_before",
                    wgpu::BindingResource::TextureView(&views[1 - which]),
                ),
                ("surfaces_after", kept[which].as_entire_binding()),
                (
                    "colours_after",
                    wgpu::BindingResource::TextureView(&views[which]),
                ),
            ];
            let all = offer.with(own.into_iter().chain(display.resources()));
            kernel.bind(gpu, &all.resources)
        });
        Ok(Self {
            kernel,
            bindings,
            uniform,
            colours,
            size,
        })
    }

    /// Writes the picture of this index; the other one is the history.
    pub fn record(&self, recorder: &mut Recorder<'_>, which: usize) {
        let groups = self.kernel.groups_of(self.size);
        recorder.run(&self.kernel, &self.bindings[which], groups);
    }

    /// Tells the next frame's threads about their history.
    pub fn set(&self, gpu: &Gpu, history: &GpuHistory) {
        gpu.queue
            .write_buffer(&self.uniform, 0, bytemuck::bytes_of(history));
    }
}
