//! The passes that light the faces which the camera sees.

use crate::{
    gpu::{Gpu, GpuError},
    passes::{
        FaceTable, ProbeField, camera_rays::CameraRays, face_blend::FaceBlend, face_mark::FaceMark,
        face_rays::FaceRays,
    },
};

pub(super) struct FaceLight {
    pub mark: FaceMark,
    pub rays: FaceRays,
    pub blend: FaceBlend,
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
}
