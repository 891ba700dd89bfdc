//! Every pass of a frame, with what it reads and writes there.

use std::thread;

use super::{
    FrameError,
    body_passes::BodyPasses,
    inspect::Inspect,
    offers::{Subjects, offer},
    values::{
        ActiveList, Drawn, FaceLight, FaceRays, ListedFaces, ListedProbes, PlacedProbes,
        ProbeLight, ProbeRays, Radiance, SeenFaces, Surfaces, Update, Wanted,
    },
};
use crate::{
    gpu::{Gpu, Offer, Recorder, made},
    passes::{
        probes::{
            blend::ProbeBlend, classify::ProbeClassify, forget_hits::ForgetHits,
            occlusion_blend::OcclusionBlend, occlusion_rays::OcclusionRays,
            schedule::ProbeSchedule, seed::ProbeSeed, source_walk::SourceWalk, trace::ProbeTrace,
            visibility::ProbeVisibility,
        },
        scene::lamp_lists::LampLists,
        surface_cache::{
            allocate::SurfaceAllocate, lamps::SurfaceLamps, resolve::SurfaceResolve,
            trace::SurfaceTrace,
        },
        view::{
            Shot, antialias::TemporalAntialias, bits::Bits, camera_rays::CameraRays, shade::Shade,
            tonemap::Tonemap,
        },
    },
};

/// The passes for pictures of one size, lit by one field of probes.
pub(super) struct Passes {
    uses_cache: bool,
    lamp_lists: LampLists,
    pub camera_rays: CameraRays,
    classify: ProbeClassify,
    /// Where there are bodies.
    bodies: Option<BodyPasses>,
    visibility: ProbeVisibility,
    seed: ProbeSeed,
    schedule: ProbeSchedule,
    walk: Option<SourceWalk>,
    forget_hits: Option<ForgetHits>,
    probe_trace: ProbeTrace,
    occlusion: (Option<OcclusionRays>, Option<OcclusionBlend>),
    blend: ProbeBlend,
    face_lamps: SurfaceLamps,
    allocate: SurfaceAllocate,
    surface_trace: SurfaceTrace,
    resolve: SurfaceResolve,
    pub shade: Shade,
    pub bits: Option<Bits>,
    pub inspect: Inspect,
    pub antialias: Option<TemporalAntialias>,
    pub tonemap: Tonemap,
}

impl Passes {
    /// `scene` is the offer of [`scene`]. Pipelines take most of the time to the first frame:
    /// they are compiled side by side.
    pub fn new(
        gpu: &Gpu,
        size: [u32; 2],
        subjects: Subjects<'_>,
        wanted: Wanted,
        scene: &Offer<'_>,
    ) -> Result<Self, FrameError> {
        let Subjects {
            field,
            cache,
            lights,
            bodies,
        } = subjects;
        let offer = offer(field, cache, scene);
        let resources = &scene.resources[..];
        let of_faces = offer.with([field.requests_of_faces(), lights.seen_by_faces()]);
        let of_pixels = offer.with([field.requests_of_pixels()]);
        let surfaces = &CameraRays::surfaces(gpu, size)?;
        let hdr = &Shade::hdr(gpu, size)?;
        thread::scope(|threads| {
            let lamp_lists = threads.spawn(|| LampLists::new(gpu, lights, resources));
            let classify = threads.spawn(|| ProbeClassify::new(gpu, field, resources));
            let bodies = threads.spawn(|| BodyPasses::new(gpu, bodies, field, &offer));
            let visibility = threads.spawn(|| ProbeVisibility::new(gpu, field, resources));
            let schedule = threads.spawn(|| ProbeSchedule::new(gpu, field));
            let seed = threads.spawn(|| ProbeSeed::new(gpu, field, resources));
            let walk = threads.spawn(|| SourceWalk::new(gpu, field, resources));
            let forget_hits = threads.spawn(|| ForgetHits::new(gpu, field, resources));
            let probe_trace = threads.spawn(|| ProbeTrace::new(gpu, field, &offer));
            let occlusion_rays = threads.spawn(|| OcclusionRays::new(gpu, field, &offer));
            let occlusion_blend = threads.spawn(|| OcclusionBlend::new(gpu, field));
            let blend = threads.spawn(|| ProbeBlend::new(gpu, field, &scene.constants));
            let surface_trace = threads.spawn(|| SurfaceTrace::new(gpu, size, cache, &of_faces));
            let resolve = threads.spawn(|| SurfaceResolve::new(gpu, size, cache, &offer));
            let face_lamps = threads.spawn(|| SurfaceLamps::new(gpu, size, cache, &offer));
            let allocate =
                threads.spawn(|| SurfaceAllocate::new(gpu, size, surfaces, cache, scene));
            let camera_rays = threads.spawn(|| CameraRays::new(gpu, surfaces.clone(), scene));
            let shade = threads.spawn(|| Shade::new(gpu, hdr.clone(), surfaces, &of_pixels));
            let bits = wanted
                .bits
                .then(|| Bits::new(gpu, hdr, surfaces, &offer))
                .transpose()?;
            let upscales = wanted.smoothing.scale < 1.0;
            let antialias = (!wanted.smoothing.is_plain())
                .then(|| TemporalAntialias::new(gpu, size, hdr, surfaces, upscales, &offer))
                .transpose()?;
            let smoothed = antialias.iter().flat_map(|pass| &pass.colours);
            let lit: Vec<_> = std::iter::once(hdr)
                .chain(smoothed)
                .map(|texture| texture.create_view(&Default::default()))
                .collect();
            let tonemap = Tonemap::new(gpu, size, &lit, resources)?;
            let (camera_rays, shade) = (made(camera_rays)?, made(shade)?);
            let inspection = wanted.inspection;
            Ok(Self {
                uses_cache: cache.is_used(),
                tonemap,
                inspect: Inspect::new(gpu, inspection, &camera_rays, &shade, field, &offer)?,
                antialias,
                bits,
                lamp_lists: made(lamp_lists)?,
                classify: made(classify)?,
                bodies: made(bodies)?,
                visibility: made(visibility)?,
                schedule: made(schedule)?,
                seed: made(seed)?,
                walk: made(walk)?,
                forget_hits: made(forget_hits)?,
                probe_trace: made(probe_trace)?,
                occlusion: (made(occlusion_rays)?, made(occlusion_blend)?),
                blend: made(blend)?,
                face_lamps: made(face_lamps)?,
                allocate: made(allocate)?,
                surface_trace: made(surface_trace)?,
                resolve: made(resolve)?,
                camera_rays,
                shade,
            })
        })
    }
}

impl Passes {
    /// A whole frame. Passes inside `concurrent` do not depend on each other.
    pub fn record(&self, recorder: &mut Recorder<'_>, update: Update, shot: &Shot, drawn: Drawn) {
        self.list_lamps(recorder, update.lists_lamps);
        let placed = self.place_probes(recorder, update);
        let (surfaces, listed_probes) = recorder.concurrent(|recorder| {
            let surfaces = self.trace_camera(recorder, drawn);
            self.ask_faces(recorder, update.asks_faces);
            if let Some(bodies) = &self.bodies {
                bodies.record(recorder, &update);
            }
            (surfaces, self.list_probes(recorder, placed))
        });
        if let Some(bodies) = &self.bodies {
            bodies.publish(recorder);
        }
        let (active, seen_faces) = recorder.concurrent(|recorder| {
            let active = self.size_list(recorder, listed_probes);
            (active, self.allocate_seen(recorder, &surfaces))
        });
        let listed_faces = self.allocate_requested(recorder, seen_faces);
        let before = (ProbeLight, FaceLight);
        let (probe_rays, face_rays, early) = recorder.concurrent(|recorder| {
            let probe_rays = self.trace_probes(recorder, &active);
            let face_rays = self.trace_faces(recorder, &listed_faces);
            let shaded = || self.shade(recorder, &surfaces, &before, shot, drawn);
            (probe_rays, face_rays, update.shades_early.then(shaded))
        });
        if let Some(radiance) = early {
            let radiance = self.draw_over(recorder, radiance, (surfaces, before), shot, drawn);
            recorder.concurrent(|recorder| {
                let probe_light = self.blend_probes(recorder, active, probe_rays);
                self.display(recorder, radiance, drawn);
                self.resolve_faces(recorder, listed_faces, face_rays, &probe_light);
            });
            return;
        }
        let probe_light = self.blend_probes(recorder, active, probe_rays);
        let face_light = self.resolve_faces(recorder, listed_faces, face_rays, &probe_light);
        self.show(recorder, surfaces, (probe_light, face_light), shot, drawn);
    }

    /// A picture of another shot, by the light of the last frame.
    pub fn record_picture(&self, recorder: &mut Recorder<'_>, shot: &Shot, drawn: Drawn) {
        let surfaces = self.trace_camera(recorder, drawn);
        self.show(recorder, surfaces, (ProbeLight, FaceLight), shot, drawn);
    }

    fn show(
        &self,
        recorder: &mut Recorder<'_>,
        surfaces: Surfaces,
        light: (ProbeLight, FaceLight),
        shot: &Shot,
        drawn: Drawn,
    ) {
        let radiance = self.shade(recorder, &surfaces, &light, shot, drawn);
        let radiance = self.draw_over(recorder, radiance, (surfaces, light), shot, drawn);
        self.display(recorder, radiance, drawn);
    }

    fn draw_over(
        &self,
        recorder: &mut Recorder<'_>,
        radiance: Radiance,
        lit: (Surfaces, (ProbeLight, FaceLight)),
        shot: &Shot,
        drawn: Drawn,
    ) -> Radiance {
        let radiance = self.draw_bits(recorder, radiance, lit, shot, drawn);
        self.inspect(recorder, radiance)
    }

    fn display(&self, recorder: &mut Recorder<'_>, radiance: Radiance, drawn: Drawn) {
        let radiance = self.antialias(recorder, radiance, drawn);
        self.tonemap(recorder, radiance, drawn);
    }

    /// Linear HDR radiance of the last picture: anti-aliased, with an index, or as it was shaded.
    pub fn radiance(&self, smoothed: Option<usize>) -> &wgpu::Texture {
        match (&self.antialias, smoothed) {
            (Some(pass), Some(which)) => &pass.colours[which],
            _ => &self.shade.hdr,
        }
    }
}

/// One method for each step of a frame: its arguments are what the step reads of this frame, its result is what it
/// writes. A value exists only once its pass is recorded, so the compiler checks the order of the passes.
impl Passes {
    /// The lists stay valid from the last frame where no lamp has moved.
    fn list_lamps(&self, recorder: &mut Recorder<'_>, is_needed: bool) {
        if is_needed {
            self.lamp_lists.record(recorder);
        }
    }

    /// Reads `update`: probes that are new, were moved, or are near an edit; and where bodies are. The places of all other
    /// probes stay valid from the last frame.
    fn place_probes(&self, recorder: &mut Recorder<'_>, update: Update) -> PlacedProbes {
        if update.places_probes {
            self.classify.record(recorder);
            if let Some(walk) = &self.walk {
                walk.record_begin(recorder);
            }
            if update.marks_visibility {
                self.visibility.record(recorder);
            }
            if update.has_fresh {
                self.seed.record(recorder);
            }
        }
        if (update.places_probes || update.moves_bodies)
            && let Some(bodies) = &self.bodies
        {
            bodies.cover(recorder);
        }
        // Probes that walk may have moved at the end of any frame.
        if let Some(forget_hits) = &self.forget_hits
            && (update.places_probes || self.walk.is_some())
        {
            forget_hits.record(recorder);
        }
        PlacedProbes
    }

    fn trace_camera(&self, recorder: &mut Recorder<'_>, drawn: Drawn) -> Surfaces {
        self.camera_rays.record(recorder, drawn.size);
        Surfaces
    }

    /// Which lamps the faces see that the last frame listed: most of them are in this picture, too.
    fn ask_faces(&self, recorder: &mut Recorder<'_>, is_needed: bool) {
        if self.uses_cache && is_needed {
            self.face_lamps.record(recorder);
        }
    }

    /// Reads the requests of the last frame.
    fn list_probes(&self, recorder: &mut Recorder<'_>, _: PlacedProbes) -> ListedProbes {
        self.schedule.record_list(recorder);
        ListedProbes
    }

    fn size_list(&self, recorder: &mut Recorder<'_>, _: ListedProbes) -> ActiveList {
        self.schedule.record_arguments(recorder);
        ActiveList
    }

    /// Gives the visible faces places in the table.
    fn allocate_seen(&self, recorder: &mut Recorder<'_>, _: &Surfaces) -> SeenFaces {
        if self.uses_cache {
            self.allocate.record(recorder);
        }
        SeenFaces
    }

    /// Gives places to the faces that rays of the last frame requested.
    fn allocate_requested(&self, recorder: &mut Recorder<'_>, _: SeenFaces) -> ListedFaces {
        if self.uses_cache {
            self.allocate.record_requested(recorder);
        }
        ListedFaces
    }

    /// Reads the light of probes and faces of the last frame: each frame adds one bounce.
    fn trace_probes(&self, recorder: &mut Recorder<'_>, _: &ActiveList) -> ProbeRays {
        self.probe_trace.record(recorder);
        ProbeRays
    }

    /// Reads the light of probes and faces of the last frame.
    fn trace_faces(&self, recorder: &mut Recorder<'_>, _: &ListedFaces) -> FaceRays {
        if self.uses_cache {
            self.surface_trace.record(recorder);
        }
        FaceRays
    }

    fn blend_probes(&self, recorder: &mut Recorder<'_>, _: ActiveList, _: ProbeRays) -> ProbeLight {
        (self.occlusion.0.iter()).for_each(|rays| rays.record(recorder));
        (self.occlusion.1.iter()).for_each(|blend| blend.record(recorder));
        self.blend.record(recorder);
        if let Some(walk) = &self.walk {
            walk.record(recorder);
        }
        ProbeLight
    }

    fn resolve_faces(
        &self,
        recorder: &mut Recorder<'_>,
        _: ListedFaces,
        _: FaceRays,
        _: &ProbeLight,
    ) -> FaceLight {
        if self.uses_cache {
            self.resolve.record(recorder);
        }
        FaceLight
    }

    /// Writes the light that arrives at the camera, or a view of data. Leaves requests for the next frame.
    fn shade(
        &self,
        recorder: &mut Recorder<'_>,
        _: &Surfaces,
        _: &(ProbeLight, FaceLight),
        shot: &Shot,
        drawn: Drawn,
    ) -> Radiance {
        let (shade, size) = (&self.shade, drawn.size);
        self.inspect.shade(recorder, shade, shot.view, size);
        Radiance
    }

    /// Draws what flies and the bulbs of lamps before the surfaces.
    fn draw_bits(
        &self,
        recorder: &mut Recorder<'_>,
        radiance: Radiance,
        _: (Surfaces, (ProbeLight, FaceLight)),
        shot: &Shot,
        drawn: Drawn,
    ) -> Radiance {
        if let Some(bits) = self.bits.as_ref().filter(|_| Bits::are_in(shot.view)) {
            bits.record(recorder, drawn.size);
        }
        radiance
    }

    /// Draws the probes themselves, if they are to be seen.
    fn inspect(&self, recorder: &mut Recorder<'_>, radiance: Radiance) -> Radiance {
        self.inspect.draw(recorder);
        radiance
    }

    /// Averages jittered pictures; of those with fewer pixels than are shown it makes one of all.
    fn antialias(&self, recorder: &mut Recorder<'_>, radiance: Radiance, drawn: Drawn) -> Radiance {
        if let (Some(pass), Some(which)) = (&self.antialias, drawn.smoothed) {
            pass.record(recorder, which);
        }
        radiance
    }

    fn tonemap(&self, recorder: &mut Recorder<'_>, _: Radiance, drawn: Drawn) {
        let which = drawn.smoothed.map_or(0, |which| 1 + which);
        self.tonemap.record(recorder, which);
    }
}
