//! Pass `face_rays`: the final gather of the faces that the camera sees.

use super::{FaceTable, ProbeField};
use crate::gpu::{Bindings, Gpu, GpuError, Kernel, KernelSpec, Recorder};

pub struct FaceRays {
    kernel: Kernel,
    bindings: Bindings,
    most: [u32; 2],
    dispatch: wgpu::Buffer,
}

impl FaceRays {
    /// For pictures of `size` pixels. `resources` are those of the voxels, the lights and the materials.
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
        let mut overrides = vec![("COHERENT", 0.0)];
        overrides.extend(field.light_overrides());
        let kernel = Kernel::new(
            gpu,
            &KernelSpec {
                shader: "passes/face_rays",
                overrides: &overrides,
                ..Default::default()
            },
        )?;
        let mut all = vec![field.work_of_faces()];
        all.extend_from_slice(resources);
        all.extend(field.resources());
        all.extend(faces.update_resources());
        all.push(("face_rays_out", faces.rays().as_entire_binding()));
        Ok(Self {
            bindings: kernel.bind(gpu, &all),
            kernel,
            most: faces.rays_most(size),
            dispatch: faces.dispatch().clone(),
        })
    }

    /// After passes `face_mark` and `probe_due`.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        let listed = (&self.dispatch, FaceTable::RAYS_OFFSET);
        recorder.run_indirect(&self.kernel, &self.bindings, self.most, listed);
    }
}
