//! Pass `view/probe_draw`: draws the probes as spheres in the picture, and lines from their lattice points.

use super::ProbeColour;
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Offer, Recorder, rectangle};

crate::shared! {
    in view;

    /// What a pixel shows of the probes.
    struct GpuMark as Mark {
        /// Bits of the distance along the camera ray (voxels): positive floats have the order of their bits.
        nearest: u32 => "atomic<u32>",
        /// Twice the slot of the probe at that distance, plus 1 for its line.
        owner: u32 => "atomic<u32>",
    }

    /// What is drawn of the probes.
    pub struct GpuDrawing as Drawing {
        /// One of the COLOUR_ constants.
        pub colour: u32,
        /// One of the STAGE_ constants.
        pub stage: u32,
        /// 1: with lines.
        pub lines: u32,
        /// A uniform's size is a multiple of 16 bytes.
        pub unused: u32,
    }

    /// Splatting finds the nearest distance.
    const STAGE_NEAREST: u32 = 0;

    /// Splatting finds the probe or line at the nearest distance.
    const STAGE_OWNER: u32 = 1;
}

pub struct ProbeDraw {
    clear: (Kernel, Bindings),
    splat: Kernel,
    /// Bindings of the two stages of `splat`: nearest distances, and their owners.
    stages: [Bindings; 2],
    draw: (Kernel, Bindings),
    probes: [u32; 2],
    pixels: [u32; 2],
}

/// Workgroups that share the pixels of a probe.
const SHARES: u32 = 16;
const MARK_BYTES: u64 = size_of::<GpuMark>() as u64;

impl ProbeDraw {
    /// Draws over `hdr` (`rgba16float`), a picture of `surfaces`. `offer` is that of the voxels, the view and the
    /// probes.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`], [`GpuError::Shader`].
    pub fn new(
        gpu: &Gpu,
        colour: ProbeColour,
        hdr: &wgpu::Texture,
        surfaces: &wgpu::Buffer,
        slots: u32,
        offer: &Offer<'_>,
    ) -> Result<Self, GpuError> {
        let size = [hdr.width(), hdr.height()];
        let marks = gpu.storage_buffer("marks", Self::bytes(size))?;
        let hdr = hdr.create_view(&Default::default());
        let drawings = [STAGE_NEAREST, STAGE_OWNER].map(|stage| {
            let lines = matches!(colour, ProbeColour::State | ProbeColour::Offset);
            let drawing = GpuDrawing {
                colour: colour as u32,
                stage,
                lines: u32::from(lines),
                ..Default::default()
            };
            gpu.uniform_buffer("drawing", &drawing)
        });
        let kernel = |entry, overrides| {
            let spec = KernelSpec {
                shader: "view/probe_draw",
                entry,
                overrides,
                offered: &offer.constants,
                ..Default::default()
            };
            Kernel::new(gpu, &spec)
        };
        let shares = [("SHARES", f64::from(SHARES))];
        let bind = |kernel: &Kernel, drawing: &wgpu::Buffer| {
            let all = offer.with([
                ("surfaces", surfaces.as_entire_binding()),
                ("marks", marks.as_entire_binding()),
                ("hdr", wgpu::BindingResource::TextureView(&hdr)),
                ("drawing", drawing.as_entire_binding()),
            ]);
            kernel.bind(gpu, &all.resources)
        };
        let (clear, splat, draw) = (
            kernel("clear", &[])?,
            kernel("splat", &shares)?,
            kernel("draw", &[])?,
        );
        Ok(Self {
            pixels: clear.groups_of(size),
            probes: rectangle(slots * SHARES),
            stages: [bind(&splat, &drawings[0]), bind(&splat, &drawings[1])],
            clear: (clear.clone(), bind(&clear, &drawings[0])),
            draw: (draw.clone(), bind(&draw, &drawings[0])),
            splat,
        })
    }

    /// Bytes of GPU memory for a picture of this size.
    pub fn bytes(size: [u32; 2]) -> u64 {
        u64::from(size[0]) * u64::from(size[1]) * MARK_BYTES
    }

    /// After the passes `view/shade` and `probes/schedule`, before pass `view/tonemap`.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        let [nearest, owners] = &self.stages;
        recorder.run(&self.clear.0, &self.clear.1, self.pixels);
        recorder.run(&self.splat, nearest, self.probes);
        recorder.run(&self.splat, owners, self.probes);
        recorder.run(&self.draw.0, &self.draw.1, self.pixels);
    }
}
