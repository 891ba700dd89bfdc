//! Pass `scene/lamp_lists`: the lamps that are brightest in each cell of the world.

use super::GpuLights;
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Recorder, rectangle};

/// See [`lights::lists`](crate::lights::lists).
pub struct LampLists {
    kernel: Kernel,
    bindings: Bindings,
    groups: [u32; 2],
}

impl LampLists {
    /// `resources` are those of the voxels.
    ///
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(
        gpu: &Gpu,
        lights: &GpuLights,
        resources: &[(&str, wgpu::BindingResource<'_>)],
    ) -> Result<Self, GpuError> {
        let spec = KernelSpec {
            shader: "scene/lamp_lists",
            ..Default::default()
        };
        let kernel = Kernel::new(gpu, &spec)?;
        let mut all = resources.to_vec();
        all.push(lights.lists());
        Ok(Self {
            bindings: kernel.bind(gpu, &all),
            kernel,
            groups: rectangle(lights.listed().count.element_product()),
        })
    }

    /// In frames in which a lamp has moved or become brighter than ever, before anything is lit.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        recorder.run(&self.kernel, &self.bindings, self.groups);
    }
}
