//! Pass `face_blend`: what the faces that the camera sees show.

use super::{FaceTable, ProbeField};
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Recorder};

pub struct FaceBlend {
    kernel: Kernel,
    bindings: Bindings,
    most: [u32; 2],
    dispatch: wgpu::Buffer,
}

impl FaceBlend {
    /// For pictures of `size` pixels. `resources` are those of the voxels.
    ///
    /// # Errors
    /// [`GpuError::Shader`].
    pub fn new(
        gpu: &Gpu,
        size: [u32; 2],
        field: &ProbeField,
        faces: &FaceTable,
        resources: &[(&str, wgpu::BindingResource<'_>)],
    ) -> Result<Self, GpuError> {
        let kernel = Kernel::new(
            gpu,
            &KernelSpec {
                shader: "passes/face_blend",
                overrides: &field.gather_overrides(),
                ..Default::default()
            },
        )?;
        let mut all = resources.to_vec();
        all.extend(field.resources());
        all.extend(faces.update_resources());
        Ok(Self {
            bindings: kernel.bind(gpu, &all),
            kernel,
            most: faces.blend_most(size),
            dispatch: faces.dispatch().clone(),
        })
    }

    /// After pass `face_rays`.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        let listed = (&self.dispatch, FaceTable::BLEND_OFFSET);
        recorder.run_indirect(&self.kernel, &self.bindings, self.most, listed);
    }
}
