//! Every pass of a frame, and the order of those that light it.

use super::{FrameError, inspect::Inspect};
use crate::{
    gpu::{Gpu, Recorder},
    parameters::{ProbeParameters, Relocation},
    passes::{
        FaceTable, Inspection, ProbeField, View, camera_rays::CameraRays, face_blend::FaceBlend,
        face_mark::FaceMark, face_rays::FaceRays, probe_blend::ProbeBlend, probe_due::ProbeDue,
        probe_rays::ProbeRays, probe_seed::ProbeSeed, probe_sight::ProbeSight,
        probe_states::ProbeStates, shade::Shade, tonemap::Tonemap,
    },
};

/// For pictures of one size, lit by one field of probes.
pub(super) struct Passes {
    pub camera_rays: CameraRays,
    pub probe_states: ProbeStates,
    pub probe_sight: ProbeSight,
    pub probe_due: ProbeDue,
    pub probe_seed: ProbeSeed,
    pub probe_rays: ProbeRays,
    pub probe_blend: ProbeBlend,
    pub face_mark: FaceMark,
    pub face_rays: FaceRays,
    pub face_blend: FaceBlend,
    pub shade: Shade,
    pub inspect: Inspect,
    pub tonemap: Tonemap,
}

impl Passes {
    pub fn new(
        gpu: &Gpu,
        size: [u32; 2],
        field: &ProbeField,
        faces: &FaceTable,
        wanted: Inspection,
        resources: &[(&str, wgpu::BindingResource<'_>)],
    ) -> Result<Self, FrameError> {
        let camera_rays = CameraRays::new(gpu, size, resources)?;
        let surfaces = &camera_rays.surfaces;
        let shade = Shade::new(gpu, size, surfaces, field, faces, resources)?;
        let hdr = shade.hdr.create_view(&Default::default());
        Ok(Self {
            tonemap: Tonemap::new(gpu, size, &hdr, resources)?,
            probe_states: ProbeStates::new(gpu, field, resources)?,
            probe_sight: ProbeSight::new(gpu, field, resources)?,
            probe_due: ProbeDue::new(gpu, field)?,
            probe_seed: ProbeSeed::new(gpu, field, resources)?,
            probe_rays: ProbeRays::new(gpu, field, resources)?,
            probe_blend: ProbeBlend::new(gpu, field)?,
            face_mark: FaceMark::new(gpu, size, surfaces, faces, resources)?,
            face_rays: FaceRays::new(gpu, size, field, faces, resources)?,
            face_blend: FaceBlend::new(gpu, size, field, faces, resources)?,
            inspect: Inspect::new(gpu, wanted, &camera_rays, &shade, field, resources)?,
            camera_rays,
            shade,
        })
    }

    /// From the camera's rays to the light of the probes and, if `faces`, that of the faces that it sees.
    pub fn record_light(&self, recorder: &mut Recorder<'_>, probes: &ProbeParameters, faces: bool) {
        recorder.together(|recorder| {
            self.camera_rays.record(recorder);
            self.probe_due.record_list(recorder);
        });
        recorder.together(|recorder| {
            self.probe_due.record_arguments(recorder);
            if faces {
                self.face_mark.record(recorder);
            }
        });
        if faces {
            self.face_mark.record_asked(recorder);
        }
        recorder.together(|recorder| {
            self.probe_rays.record(recorder);
            if faces {
                self.face_rays.record(recorder);
            }
        });
        self.probe_blend.record(recorder);
        if probes.relocation == Relocation::Statistical {
            self.probe_states.record_walk(recorder);
        }
        if faces {
            self.face_blend.record(recorder);
        }
    }

    /// From what the camera rays hit to the display.
    pub fn record_picture(&self, recorder: &mut Recorder<'_>, view: &View) {
        self.inspect.record(recorder, &self.shade, view.mode);
        self.tonemap.record(recorder);
    }
}
