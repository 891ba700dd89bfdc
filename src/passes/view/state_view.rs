//! Pass `view/state_view`: the states of the probes that light each point, in place of the picture.

use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Offer, Recorder, rectangle};

pub struct StateView {
    paint: (Kernel, Bindings),
    main: (Kernel, Bindings),
    probes: [u32; 2],
    tiles: [u32; 2],
    /// Ambient cubes, packed as in `shaders/probes/probe_cube.wesl`, but with the colour of the probe's state (linear,
    /// for the display) on all sides.
    pub cubes: wgpu::Buffer,
}

impl StateView {
    /// Draws over `hdr` (`rgba16float`), a picture of `surfaces`. `offer` is that of the voxels, the view and the
    /// probes, whose number is `slots`, and whose cubes take `cube_bytes`.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`], [`GpuError::Shader`].
    pub fn new(
        gpu: &Gpu,
        hdr: &wgpu::Texture,
        surfaces: &wgpu::Buffer,
        slots: u32,
        cube_bytes: u64,
        offer: &Offer<'_>,
    ) -> Result<Self, GpuError> {
        let cubes = gpu.storage_buffer("painted_cubes", cube_bytes)?;
        let kernel = |entry| {
            let spec = KernelSpec {
                shader: "view/state_view",
                entry,
                offered: &offer.constants,
                ..Default::default()
            };
            Kernel::new(gpu, &spec)
        };
        let hdr_view = hdr.create_view(&Default::default());
        let all = offer.with([
            ("surfaces", surfaces.as_entire_binding()),
            ("hdr", wgpu::BindingResource::TextureView(&hdr_view)),
            ("painted_cubes", cubes.as_entire_binding()),
        ]);
        let paint = kernel("paint")?;
        let painting = paint.bind(gpu, &all.resources);
        let painted = all.with([("ambient_cubes", cubes.as_entire_binding())]);
        let main = kernel("main")?;
        let [columns, rows] = main.groups_of([hdr.width(), hdr.height()]);
        Ok(Self {
            probes: rectangle(slots.div_ceil(paint.workgroup_size[0])),
            tiles: rectangle(columns * rows),
            paint: (paint, painting),
            main: (main.clone(), main.bind(gpu, &painted.resources)),
            cubes,
        })
    }

    /// After the passes `view/camera_rays` and `probes/blend`, in place of pass `view/shade`.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        recorder.run(&self.paint.0, &self.paint.1, self.probes);
        recorder.run(&self.main.0, &self.main.1, self.tiles);
    }
}
