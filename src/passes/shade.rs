//! Pass `shade`: lights what the camera rays hit.

use super::ProbeField;
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Recorder, rectangle};

/// The kernel and the picture that it writes.
pub struct Shade {
    kernel: Kernel,
    bindings: Bindings,
    /// `rgba16float`: linear HDR radiance (or the view's data), alpha 1; rows from the top.
    pub hdr: wgpu::Texture,
}

impl Shade {
    /// For pictures of `size` pixels. `surfaces` is what the camera rays hit; `resources` are those
    /// of the voxels, the view, the lights and the materials.
    ///
    /// # Errors
    /// [`GpuError::Shader`], and [`GpuError::TooLarge`] for a picture that no texture can hold.
    pub fn new(
        gpu: &Gpu,
        size: [u32; 2],
        surfaces: &wgpu::Buffer,
        field: &ProbeField,
        resources: &[(&str, wgpu::BindingResource<'_>)],
    ) -> Result<Self, GpuError> {
        let format = wgpu::TextureFormat::Rgba16Float;
        let hdr = gpu.texture("hdr", [size[0], size[1], 1], format)?;
        let kernel = Kernel::new(
            gpu,
            &KernelSpec {
                shader: "passes/shade",
                overrides: &[("EXACT", f64::from(u8::from(field.exact())))],
                ..Default::default()
            },
        )?;
        Ok(Self {
            bindings: bind(gpu, &kernel, &hdr, surfaces, field, None, resources),
            kernel,
            hdr,
        })
    }

    /// The same with others in the place of the field's ambient cubes: what the picture gathers.
    pub fn bind(
        &self,
        gpu: &Gpu,
        surfaces: &wgpu::Buffer,
        field: &ProbeField,
        gathered: &wgpu::Buffer,
        resources: &[(&str, wgpu::BindingResource<'_>)],
    ) -> Bindings {
        let (kernel, hdr) = (&self.kernel, &self.hdr);
        bind(gpu, kernel, hdr, surfaces, field, Some(gathered), resources)
    }

    pub fn record(&self, recorder: &mut Recorder<'_>) {
        self.record_with(recorder, &self.bindings);
    }

    /// With bindings of [`Self::bind`].
    pub fn record_with(&self, recorder: &mut Recorder<'_>, bindings: &Bindings) {
        let [columns, rows] = self.kernel.groups_of([self.hdr.width(), self.hdr.height()]);
        recorder.run(&self.kernel, bindings, rectangle(columns * rows));
    }
}

fn bind(
    gpu: &Gpu,
    kernel: &Kernel,
    hdr: &wgpu::Texture,
    surfaces: &wgpu::Buffer,
    field: &ProbeField,
    gathered: Option<&wgpu::Buffer>,
    resources: &[(&str, wgpu::BindingResource<'_>)],
) -> Bindings {
    let hdr_view = hdr.create_view(&Default::default());
    // The first of a name is bound.
    let cubes = gathered.map(|cubes| ("ambient_cubes", cubes.as_entire_binding()));
    let mut all: Vec<_> = cubes.into_iter().collect();
    all.extend_from_slice(resources);
    all.extend(field.resources());
    all.push(("surfaces", surfaces.as_entire_binding()));
    all.push(("hdr", wgpu::BindingResource::TextureView(&hdr_view)));
    kernel.bind(gpu, &all)
}
