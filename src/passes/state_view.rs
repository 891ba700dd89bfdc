//! Pass `state_view`: what the probes that light each point are doing, in place of the picture.

use super::ProbeField;
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Recorder, rectangle};

pub struct StateView {
    paint: (Kernel, Bindings),
    main: (Kernel, Bindings),
    probes: [u32; 2],
    tiles: [u32; 2],
    /// Light along the axes, packed as `shaders/probes/probe_cube.wesl` has it, but with the colour of the
    /// state (linear for the display) on all sides.
    pub cubes: wgpu::Buffer,
}

impl StateView {
    /// Over `hdr` (`rgba16float`), a picture of what `surfaces` holds. `resources` are those of the voxels
    /// and the view.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`], [`GpuError::Shader`].
    pub fn new(
        gpu: &Gpu,
        hdr: &wgpu::Texture,
        surfaces: &wgpu::Buffer,
        field: &ProbeField,
        resources: &[(&str, wgpu::BindingResource<'_>)],
    ) -> Result<Self, GpuError> {
        let cubes = gpu.storage_buffer("painted_cubes", field.memory().ambient_cubes)?;
        let overrides = field.gather_overrides();
        let kernel = |entry| {
            let spec = KernelSpec {
                shader: "passes/state_view",
                entry,
                overrides: &overrides,
                ..Default::default()
            };
            Kernel::new(gpu, &spec)
        };
        let hdr_view = hdr.create_view(&Default::default());
        let mut all = resources.to_vec();
        all.push(("surfaces", surfaces.as_entire_binding()));
        all.push(("hdr", wgpu::BindingResource::TextureView(&hdr_view)));
        all.push(("painted_cubes", cubes.as_entire_binding()));
        let own = all.len();
        all.extend(field.resources());
        all.extend(field.due_resources());
        let paint = kernel("paint")?;
        let painting = paint.bind(gpu, &all);
        // The first of a name is bound.
        all.insert(own, ("ambient_cubes", cubes.as_entire_binding()));
        let main = kernel("main")?;
        let [columns, rows] = main.groups_of([hdr.width(), hdr.height()]);
        Ok(Self {
            probes: rectangle(field.atlas().slots.div_ceil(paint.workgroup_size[0])),
            tiles: rectangle(columns * rows),
            paint: (paint, painting),
            main: (main.clone(), main.bind(gpu, &all)),
            cubes,
        })
    }

    /// After the passes `camera_rays` and `probe_blend`, in place of pass `shade`.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        recorder.run(&self.paint.0, &self.paint.1, self.probes);
        recorder.run(&self.main.0, &self.main.1, self.tiles);
    }
}
