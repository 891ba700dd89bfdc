//! Pass `shade`: lights what the camera rays hit.

use super::{FaceTable, ProbeField};
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
        faces: &FaceTable,
        resources: &[(&str, wgpu::BindingResource<'_>)],
    ) -> Result<Self, GpuError> {
        let format = wgpu::TextureFormat::Rgba16Float;
        let hdr = gpu.texture("hdr", [size[0], size[1], 1], format)?;
        let mut overrides = field.light_overrides().to_vec();
        overrides.extend(faces.overrides());
        let kernel = Kernel::new(
            gpu,
            &KernelSpec {
                shader: "passes/shade",
                overrides: &overrides,
                ..Default::default()
            },
        )?;
        let hdr_view = hdr.create_view(&Default::default());
        let mut all = resources.to_vec();
        all.extend(field.resources());
        all.extend(faces.resources());
        all.push(("surfaces", surfaces.as_entire_binding()));
        all.push(("hdr", wgpu::BindingResource::TextureView(&hdr_view)));
        Ok(Self {
            bindings: kernel.bind(gpu, &all),
            kernel,
            hdr,
        })
    }

    pub fn record(&self, recorder: &mut Recorder<'_>) {
        let [columns, rows] = self.kernel.groups_of([self.hdr.width(), self.hdr.height()]);
        recorder.run(&self.kernel, &self.bindings, rectangle(columns * rows));
    }
}
