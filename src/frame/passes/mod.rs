//! Every pass of a frame, in their order.

mod steps;

use std::thread;

use super::{
    FrameError,
    body_passes::BodyPasses,
    inspect::Inspect,
    offers::{Subjects, offer},
    values::{
        ActiveList, ClassifiedProbes, Drawn, FaceLight, ListedFaces, ProbeLight, Radiance,
        Surfaces, Update, Wanted,
    },
};
use crate::{
    gpu::{Gpu, Offer, Recorder, made},
    passes::{
        probes::{
            blend::ProbeBlend, blend_distances::ProbeBlendDistances, classify::ProbeClassify,
            forget_hits::ForgetHits, occlusion_blend::OcclusionBlend,
            occlusion_rays::OcclusionRays, rhythms::ProbeRhythms, schedule::ProbeSchedule,
            seed::ProbeSeed, source_walk::SourceWalk, trace::ProbeTrace,
            visibility::ProbeVisibility,
        },
        scene::lamp_lists::LampLists,
        surface_cache::{
            allocate::SurfaceAllocate, cell_shadows::SurfaceCellShadows, estimate::SurfaceEstimate,
            gains::SurfaceGains, lamps::SurfaceLamps, place_requested::PlaceRequested,
            resolve::SurfaceResolve, trace::SurfaceTrace,
        },
        view::{
            Display, Shot, antialias::TemporalAntialias, bits::Bits, camera_rays::CameraRays,
            shade::Shade, tonemap::Tonemap,
        },
    },
};

/// The passes for pictures of one size, lit by one field of probes.
pub(super) struct Passes {
    uses_cache: bool,
    lamp_lists: LampLists,
    cell_shadows: SurfaceCellShadows,
    pub camera_rays: CameraRays,
    classify: ProbeClassify,
    /// Where there are bodies.
    bodies: Option<BodyPasses>,
    pub visibility: ProbeVisibility,
    seed: ProbeSeed,
    schedule: ProbeSchedule,
    walk: Option<SourceWalk>,
    forget_hits: Option<ForgetHits>,
    probe_trace: ProbeTrace,
    occlusion: (Option<OcclusionRays>, Option<OcclusionBlend>),
    blend: ProbeBlend,
    /// Where probes keep distances.
    blend_distances: Option<ProbeBlendDistances>,
    rhythms: Option<ProbeRhythms>,
    face_lamps: SurfaceLamps,
    allocate: SurfaceAllocate,
    surface_trace: SurfaceTrace,
    estimate: SurfaceEstimate,
    gains: Option<SurfaceGains>,
    place_requested: PlaceRequested,
    resolve: SurfaceResolve,
    pub shade: Shade,
    pub bits: Option<Bits>,
    pub inspect: Inspect,
    pub antialias: Option<TemporalAntialias>,
    tonemap: Tonemap,
    pub display: Display,
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
        let of_cells = offer.with([lights.lists(), lights.cells_seen()]);
        let seen = scene.with([lights.cells_seen()]);
        let of_quadrants = offer.with([field.requests_of_quadrants()]);
        let of_pixels = offer.with([field.requests_of_pixels()]);
        let surfaces = &CameraRays::surfaces(gpu, size)?;
        let hdr = &Shade::hdr(gpu, size)?;
        let display = &Display::new(gpu, size)?;
        thread::scope(|threads| {
            let lamp_lists = threads.spawn(|| LampLists::new(gpu, lights, resources));
            let cell_shadows =
                threads.spawn(|| SurfaceCellShadows::new(gpu, lights.of_sight(), &of_cells));
            let classify = threads.spawn(|| ProbeClassify::new(gpu, field, resources));
            let bodies = threads.spawn(|| BodyPasses::new(gpu, bodies, field, cache, &offer));
            let visibility = threads.spawn(|| ProbeVisibility::new(gpu, field, resources));
            let schedule = threads.spawn(|| ProbeSchedule::new(gpu, field, &scene.constants));
            let seed = threads.spawn(|| ProbeSeed::new(gpu, field, resources));
            let walk = threads.spawn(|| SourceWalk::new(gpu, field, resources));
            let forget_hits = threads.spawn(|| ForgetHits::new(gpu, field, resources));
            let probe_trace = threads.spawn(|| ProbeTrace::new(gpu, field, &offer));
            let occlusion_rays = threads.spawn(|| OcclusionRays::new(gpu, field, &offer));
            let occlusion_blend = threads.spawn(|| OcclusionBlend::new(gpu, field));
            let blend = threads.spawn(|| ProbeBlend::new(gpu, field, &scene.constants));
            let blend_distances =
                threads.spawn(|| ProbeBlendDistances::new(gpu, field, &scene.constants));
            let rhythms = threads.spawn(|| ProbeRhythms::new(gpu, field, resources));
            let surface_trace = threads.spawn(|| SurfaceTrace::new(gpu, size, cache, &of_faces));
            let estimate = threads.spawn(|| SurfaceEstimate::new(gpu, size, cache, &of_quadrants));
            let gains = threads.spawn(|| SurfaceGains::new(gpu, cache, &offer));
            let resolve = threads.spawn(|| SurfaceResolve::new(gpu, size, cache, &offer));
            let face_lamps = threads.spawn(|| SurfaceLamps::new(gpu, size, cache, &offer));
            let allocate =
                threads.spawn(|| SurfaceAllocate::new(gpu, size, surfaces, cache, &seen));
            let place_requested = threads.spawn(|| PlaceRequested::new(gpu, cache, scene));
            let camera_rays = threads.spawn(|| CameraRays::new(gpu, surfaces.clone(), scene));
            let shade =
                threads.spawn(|| Shade::new(gpu, hdr.clone(), surfaces, display, &of_pixels));
            let bits = wanted
                .bits
                .then(|| Bits::new(gpu, hdr, surfaces, &offer))
                .transpose()?;
            let upscales = wanted.smoothing.scale < 1.0;
            let antialias = (!wanted.smoothing.is_plain())
                .then(|| TemporalAntialias::new(gpu, display, hdr, surfaces, upscales, &offer))
                .transpose()?;
            let tonemap = Tonemap::new(gpu, display, hdr, resources)?;
            let (camera_rays, shade) = (made(camera_rays)?, made(shade)?);
            let inspection = wanted.inspection;
            Ok(Self {
                uses_cache: cache.is_used(),
                tonemap,
                display: display.clone(),
                inspect: Inspect::new(gpu, inspection, &camera_rays, &shade, field, &offer)?,
                antialias,
                bits,
                lamp_lists: made(lamp_lists)?,
                cell_shadows: made(cell_shadows)?,
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
                blend_distances: made(blend_distances)?,
                rhythms: made(rhythms)?,
                face_lamps: made(face_lamps)?,
                allocate: made(allocate)?,
                surface_trace: made(surface_trace)?,
                place_requested: made(place_requested)?,
                estimate: made(estimate)?,
                gains: made(gains)?,
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
        recorder.concurrent(|recorder| {
            self.examine_shadows(recorder, update.examines_shadows);
            self.find_body_cells(recorder, update.finds_body_cells);
            self.cover_probes(recorder, update.moves_bodies && !update.places_probes);
        });
        // Beside all pixels and faces it takes hardly any time that probes near an edit look around: they are few.
        let classified = if update.places_probes {
            recorder.concurrent(|recorder| {
                self.ask_faces(recorder, update.asks_faces);
                self.classify_probes(recorder)
            })
        } else {
            ClassifiedProbes
        };
        let (surfaces, placed) = recorder.concurrent(|recorder| {
            self.find_gains(recorder);
            let sighted = self.look_around(recorder, update, classified);
            if update.places_probes {
                let surfaces = self.trace_camera(recorder, drawn);
                let placed = self.place_probes(recorder, update, sighted);
                self.examine_bodies(recorder, &update, &placed);
                (surfaces, placed)
            } else {
                // Rays of bodies are few but take as long as any, so they begin before the many of the camera.
                let placed = self.place_probes(recorder, update, sighted);
                self.examine_bodies(recorder, &update, &placed);
                let surfaces = self.trace_camera(recorder, drawn);
                self.ask_faces(recorder, update.asks_faces);
                (surfaces, placed)
            }
        });
        let (active, listed_faces) = recorder.concurrent(|recorder| {
            if let Some(bodies) = &self.bodies {
                bodies.publish(recorder);
            }
            let active = self.list_probes(recorder, placed);
            (active, self.list_faces(recorder, &surfaces))
        });
        let light = if update.follows_change {
            let probe_light = self.light_probes(recorder, &active, update.bounces);
            self.light_faces(recorder, listed_faces, probe_light)
        } else {
            let before = (ProbeLight, FaceLight);
            let (probe_rays, face_rays, estimates, early) = recorder.concurrent(|recorder| {
                let probe_rays = self.trace_probes(recorder, &active);
                let face_rays = self.trace_faces(recorder, &listed_faces, &before.0);
                let estimates = (update.estimates_early)
                    .then(|| self.estimate_faces(recorder, &listed_faces, &before.0));
                let shaded = || self.shade(recorder, &surfaces, &before, shot, drawn);
                let early = update.shades_early.then(shaded);
                (probe_rays, face_rays, estimates, early)
            });
            let estimates = match (early, estimates) {
                (Some(radiance), Some(estimates)) => {
                    let radiance =
                        self.draw_over(recorder, radiance, (surfaces, before), shot, drawn);
                    recorder.concurrent(|recorder| {
                        let probe_light = self.blend_probes(recorder, &active, probe_rays);
                        self.move_probes(recorder, &probe_light);
                        self.resolve_faces(recorder, listed_faces, &face_rays, estimates);
                        self.display(recorder, radiance, drawn);
                        self.place_requested(recorder, &face_rays);
                    });
                    return;
                }
                (_, estimates) => estimates,
            };
            let probe_light = recorder.concurrent(|recorder| {
                self.place_requested(recorder, &face_rays);
                let probe_light = self.blend_probes(recorder, &active, probe_rays);
                self.move_probes(recorder, &probe_light);
                probe_light
            });
            let estimates = estimates
                .unwrap_or_else(|| self.estimate_faces(recorder, &listed_faces, &probe_light));
            let face_light = self.resolve_faces(recorder, listed_faces, &face_rays, estimates);
            (probe_light, face_light)
        };
        self.show(recorder, surfaces, light, shot, drawn);
    }

    /// Several bounces go from probe to probe in one frame.
    fn light_probes(
        &self,
        recorder: &mut Recorder<'_>,
        active: &ActiveList,
        bounces: u32,
    ) -> ProbeLight {
        let rays = self.trace_probes(recorder, active);
        let mut light = recorder.concurrent(|recorder| self.blend_probes(recorder, active, rays));
        for _ in 1..bounces {
            light = self.bounce(recorder, active, light);
        }
        self.move_probes(recorder, &light);
        light
    }

    /// By the light of probes in this frame.
    fn light_faces(
        &self,
        recorder: &mut Recorder<'_>,
        faces: ListedFaces,
        probe_light: ProbeLight,
    ) -> (ProbeLight, FaceLight) {
        let (rays, estimates) = recorder.concurrent(|recorder| {
            let rays = self.trace_faces(recorder, &faces, &probe_light);
            let estimates = self.estimate_faces(recorder, &faces, &probe_light);
            (rays, estimates)
        });
        let face_light = recorder.concurrent(|recorder| {
            self.place_requested(recorder, &rays);
            self.resolve_faces(recorder, faces, &rays, estimates)
        });
        (probe_light, face_light)
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
