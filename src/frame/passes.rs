//! Every pass of a frame, and the order of those that light it.

use super::{FrameError, inspect::Inspect};
use crate::{
    gpu::{Gpu, Offer, Recorder},
    passes::{
        probes::{
            ProbeField, blend::ProbeBlend, classify::ProbeClassify, schedule::ProbeSchedule,
            seed::ProbeSeed, source_walk::SourceWalk, trace::ProbeTrace,
            visibility::ProbeVisibility,
        },
        surface_cache::{
            SurfaceCache, allocate::SurfaceAllocate, resolve::SurfaceResolve, trace::SurfaceTrace,
        },
        view::{Inspection, View, camera_rays::CameraRays, shade::Shade, tonemap::Tonemap},
    },
};

/// For pictures of one size, lit by one field of probes.
pub(super) struct Passes {
    pub camera_rays: CameraRays,
    pub classify: ProbeClassify,
    pub visibility: ProbeVisibility,
    pub seed: ProbeSeed,
    schedule: ProbeSchedule,
    pub walk: Option<SourceWalk>,
    probe_trace: ProbeTrace,
    blend: ProbeBlend,
    allocate: SurfaceAllocate,
    surface_trace: SurfaceTrace,
    resolve: SurfaceResolve,
    pub shade: Shade,
    pub inspect: Inspect,
    pub tonemap: Tonemap,
}

impl Passes {
    /// `scene` are the resources of the voxels, the materials, the lights and the view.
    pub fn new(
        gpu: &Gpu,
        size: [u32; 2],
        field: &ProbeField,
        cache: &SurfaceCache,
        wanted: Inspection,
        scene: &[(&'static str, wgpu::BindingResource<'_>)],
    ) -> Result<Self, FrameError> {
        let offer = offer(field, cache, scene);
        let requests_apart = offer.with([field.requests_of_faces()]);
        let camera_rays = CameraRays::new(gpu, size, scene)?;
        let surfaces = &camera_rays.surfaces;
        let shade = Shade::new(gpu, size, surfaces, &offer)?;
        let hdr = shade.hdr.create_view(&Default::default());
        Ok(Self {
            tonemap: Tonemap::new(gpu, size, &hdr, scene)?,
            classify: ProbeClassify::new(gpu, field, scene)?,
            visibility: ProbeVisibility::new(gpu, field, scene)?,
            schedule: ProbeSchedule::new(gpu, field)?,
            seed: ProbeSeed::new(gpu, field, scene)?,
            walk: SourceWalk::new(gpu, field, scene)?,
            probe_trace: ProbeTrace::new(gpu, field, scene)?,
            blend: ProbeBlend::new(gpu, field)?,
            allocate: SurfaceAllocate::new(gpu, size, surfaces, cache, scene)?,
            surface_trace: SurfaceTrace::new(gpu, size, cache, &requests_apart)?,
            resolve: SurfaceResolve::new(gpu, size, cache, &offer)?,
            inspect: Inspect::new(gpu, wanted, &camera_rays, &shade, field, &offer)?,
            camera_rays,
            shade,
        })
    }

    /// From the camera's rays to the light of the probes and, if there is a `cache`, that of the surfaces that
    /// the camera sees.
    pub fn record_light(&self, recorder: &mut Recorder<'_>, cache: bool) {
        recorder.concurrent(|recorder| {
            self.camera_rays.record(recorder);
            self.schedule.record_list(recorder);
        });
        recorder.concurrent(|recorder| {
            self.schedule.record_arguments(recorder);
            if cache {
                self.allocate.record(recorder);
            }
        });
        if cache {
            self.allocate.record_requested(recorder);
        }
        recorder.concurrent(|recorder| {
            self.probe_trace.record(recorder);
            if cache {
                self.surface_trace.record(recorder);
            }
        });
        self.blend.record(recorder);
        if let Some(walk) = &self.walk {
            walk.record(recorder);
        }
        if cache {
            self.resolve.record(recorder);
        }
    }

    /// From what the camera rays hit to the display.
    pub fn record_picture(&self, recorder: &mut Recorder<'_>, view: &View) {
        self.inspect.record(recorder, &self.shade, view.mode);
        self.tonemap.record(recorder);
    }
}

/// What subjects give to each other: the scene, the light of the probes, and that of surfaces.
pub fn offer<'a>(
    field: &'a ProbeField,
    cache: &'a SurfaceCache,
    scene: &[(&'a str, wgpu::BindingResource<'a>)],
) -> Offer<'a> {
    let mut resources = scene.to_vec();
    resources.extend(field.resources());
    resources.extend(field.schedule_resources());
    resources.extend(cache.resources());
    let mut constants = field.gather_constants().to_vec();
    constants.extend(cache.constants());
    Offer {
        resources,
        constants,
    }
}
