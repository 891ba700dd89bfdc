//! Pass `view/shade`: lights what the camera rays hit.

use super::Display;
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Offer, Recorder, rectangle};

/// Its requests for probes come from pixels alone: package::probes::requests.
const OF_PIXELS: (&str, f64) = ("FIRST_REQUESTER", 1.0);

/// The kernel and the picture that it writes.
pub struct Shade {
    kernel: Kernel,
    bindings: Bindings,
    /// For the pixels on bodies, where there are bodies.
    on_bodies: Option<(Kernel, Bindings)>,
    /// `rgba16float`: linear HDR radiance (or the view's data), alpha 1; rows from the top.
    pub hdr: wgpu::Texture,
}

impl Shade {
    /// `offered`: the constants of the offer. `on_bodies`: for the pixels on bodies.
    pub fn spec<'a>(on_bodies: bool, offered: &'a [(&'a str, f64)]) -> KernelSpec<'a> {
        let (entry, overrides): (_, &[_]) = match on_bodies {
            true => ("on_bodies", &[("ON_BODIES", 1.0), OF_PIXELS]),
            false => ("main", &[("ON_BODIES", 0.0), OF_PIXELS]),
        };
        KernelSpec {
            shader: "view/shade",
            entry,
            overrides,
            offered,
            ..Default::default()
        }
    }

    /// A picture of at most `size` pixels.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`] for a picture that no texture can hold.
    pub fn hdr(gpu: &Gpu, size: [u32; 2]) -> Result<wgpu::Texture, GpuError> {
        let format = wgpu::TextureFormat::Rgba16Float;
        gpu.texture("hdr", [size[0], size[1], 1], format)
    }

    /// `surfaces` is what the camera rays hit, and `display` where finished pictures are shown; `offer` is that of the scene, the probes and the surface cache.
    ///
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(
        gpu: &Gpu,
        hdr: wgpu::Texture,
        surfaces: &wgpu::Buffer,
        display: &Display,
        offer: &Offer<'_>,
    ) -> Result<Self, GpuError> {
        let spec = |on_bodies| Self::spec(on_bodies, &offer.constants);
        let (kernel, on_bodies) = if offer.constants.contains(&("BODIES", 1.0)) {
            let [kernel, on_bodies] = Kernel::of_one_shader(gpu, &[spec(false), spec(true)])?;
            (kernel, Some(on_bodies))
        } else {
            (Kernel::new(gpu, &spec(false))?, None)
        };
        let hdr_view = hdr.create_view(&Default::default());
        let own = [
            ("surfaces", surfaces.as_entire_binding()),
            ("hdr", wgpu::BindingResource::TextureView(&hdr_view)),
        ];
        let all = offer.with(own.into_iter().chain(display.resources()));
        let bound = |kernel: Kernel| {
            let bindings = kernel.bind(gpu, &all.resources);
            (kernel, bindings)
        };
        Ok(Self {
            bindings: kernel.bind(gpu, &all.resources),
            kernel,
            on_bodies: on_bodies.map(bound),
            hdr,
        })
    }

    /// `size` is that of the frame's view, and `body_tiles` what it says of them.
    pub fn record(&self, recorder: &mut Recorder<'_>, size: [u32; 2], body_tiles: [u32; 4]) {
        let [columns, rows] = self.kernel.groups_of(size);
        recorder.run(&self.kernel, &self.bindings, rectangle(columns * rows));
        let [_, _, columns, rows] = body_tiles;
        if let Some((kernel, bindings)) = &self.on_bodies
            && columns * rows > 0
        {
            recorder.run(kernel, bindings, rectangle(columns * rows));
        }
    }
}
