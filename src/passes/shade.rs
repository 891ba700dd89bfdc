//! Pass `shade`: lights what the camera rays hit.

use super::ProbeField;
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Recorder};

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
        let most = gpu.limits.max_texture_dimension_2d;
        if size[0].max(size[1]) > most {
            return Err(GpuError::TooLarge {
                what: format!("a picture of {}×{} pixels", size[0], size[1]),
                bytes: u64::from(size[0]) * u64::from(size[1]) * 8,
                adapter: gpu.summary.name.clone(),
                limit: u64::from(most),
                limit_name: "max_texture_dimension_2d",
                remedy: "Choose a smaller --size.",
            });
        }
        let hdr = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("hdr"),
            size: wgpu::Extent3d {
                width: size[0],
                height: size[1],
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba16Float,
            usage: wgpu::TextureUsages::STORAGE_BINDING
                | wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let kernel = Kernel::new(
            gpu,
            &KernelSpec {
                shader: "passes/shade",
                ..Default::default()
            },
        )?;
        let hdr_view = hdr.create_view(&Default::default());
        let mut all = resources.to_vec();
        all.extend(field.resources());
        all.push(("surfaces", surfaces.as_entire_binding()));
        all.push(("hdr", wgpu::BindingResource::TextureView(&hdr_view)));
        Ok(Self {
            bindings: kernel.bind(gpu, &all),
            kernel,
            hdr,
        })
    }

    pub fn record(&self, recorder: &mut Recorder<'_>) {
        recorder.compute("shade", |pass| {
            let size = [self.hdr.width(), self.hdr.height(), 1];
            self.kernel.dispatch_threads(pass, &self.bindings, size);
        });
    }
}
