//! The passes that light the faces which the camera sees.

use crate::{
    gpu::{Gpu, GpuError, Recorder},
    passes::{
        FaceTable, ProbeField, camera_rays::CameraRays, face_blend::FaceBlend, face_mark::FaceMark,
        face_rays::FaceRays,
    },
};

pub(super) struct FaceLight {
    mark: FaceMark,
    rays: FaceRays,
    blend: FaceBlend,
}

impl FaceLight {
    /// For pictures of `size` pixels.
    pub fn new(
        gpu: &Gpu,
        size: [u32; 2],
        camera_rays: &CameraRays,
        field: &ProbeField,
        faces: &FaceTable,
        resources: &[(&str, wgpu::BindingResource<'_>)],
    ) -> Result<Self, GpuError> {
        Ok(Self {
            mark: FaceMark::new(gpu, size, &camera_rays.surfaces, faces, resources)?,
            rays: FaceRays::new(gpu, size, field, faces, resources)?,
            blend: FaceBlend::new(gpu, size, field, faces, resources)?,
        })
    }

    /// After the camera's rays and the update of the probes.
    pub fn record(&self, recorder: &mut Recorder<'_>) {
        self.mark.record(recorder);
        self.rays.record(recorder);
        self.blend.record(recorder);
    }
}
