//! The whole frame on one page, as data flow.
//!
//! ```text
//! scene/lamp_lists (lamps that move, where there are many) ─ the lamps of each cell, for all that follows
//! surface_cache/cell_shadows (from 13 lamps on) ─ which of them stone hides from cells, for faces and pixels
//! probes/classify (new probes, volumes that move, edits) ─ where probes are ─ probes/schedule ─ which are updated
//!     ├ probes/cover, surface_cache/body_cells (bodies that move), surface_cache/body_light, scene/publish_facts ─ probes in bodies, light of bodies
//!     ├ probes/visibility (exact visibility) ─ which surfaces probes see
//!     ├ probes/seed (volumes that move) ─ what new probes show until their first update
//!     └ probes/forget_hits (`probes.hits=kept`) ─ which kept hits are still true
//! probes/trace ─ radiance, distance ─ probes/blend ─ atlas ──┬────────────────┐    (then probes/rhythms: which lamps it comes from)
//!     └────────────── atlas of the last frame ◄───────────┤                │
//! view/camera_rays ─ surfaces ─ surface_cache/{lamps, body_shafts, allocate ─ trace, estimate ─ resolve} ─ view/shade ─ hdr ─ view/antialias ─ display
//!                        └────────────────────────────────────────────────────┘    └ views of the probes, view/tonemap
//! ```

mod antialias;
mod bits;
mod bodies;
mod body_passes;
mod count;
mod early;
mod error;
mod inspect;
mod lamp_kinds;
mod lost;
mod memory;
mod offers;
mod order;
mod passes;
mod pictures;
mod replace;
mod stage;
mod traced;
mod values;

pub use antialias::{Smoothing, scaled};
pub use early::{begin_shaders, begin_world};
pub use error::FrameError;
pub use stage::{BuildReport, Stage, scene};
pub use traced::{TraceRequest, Traced, TracedFrame, trace, trace_blocks};

use antialias::Antialiasing;
use bits::DrawnBits;
use inspect::Inspect;
use offers::Subjects;
pub use offers::offer;
use order::FrameOrder;
use passes::Passes;
use values::{Drawn, Update, Wanted};

use crate::{
    gpu::{Gpu, Recorder},
    lights::{
        BuriedLamps, CellShadows, CommonGain, LampRanks, Lights, LightsKept, RecentLights,
        RestingLamps, table::LightsOfFrame,
    },
    parameters::ProbeParameters,
    passes::{
        probes::{OcclusionFrame, ProbeField},
        scene::GpuLights,
        surface_cache::{NextFrame, SurfaceCache},
        view::{Inspection, Shot},
    },
    probes::{
        changes::{BODY_JUMP, GREAT_ALERT, change_of_bodies},
        warmup_frames,
    },
    world::{
        LayoutSpec,
        voxels::{Edit, Voxels},
    },
};

/// Everything between a [`Stage`] and a picture of one size, lit by one field of probes.
pub struct Frame {
    pub stage: Stage,
    size: [u32; 2],
    frames: u32,
    view: wgpu::Buffer,
    lights: GpuLights,
    gain: CommonGain,
    resting: RestingLamps,
    ranks: LampRanks,
    /// At their reference intensities.
    recent_lights: RecentLights,
    buried: BuriedLamps,
    field: ProbeField,
    faces: SurfaceCache,
    passes: Passes,
    order: FrameOrder,
    antialiasing: Antialiasing,
    bits: DrawnBits,
    drawn: Drawn,
}

impl Frame {
    /// # Errors
    /// [`FrameError`] when the adapter cannot hold the picture or the probes, or when the layout is invalid.
    pub fn new(
        gpu: &Gpu,
        stage: Stage,
        layout: &LayoutSpec,
        probes: &ProbeParameters,
        size: [u32; 2],
    ) -> Result<Self, FrameError> {
        let view = Shot::buffer(gpu);
        let lights = GpuLights::new(gpu, Some(stage.voxels.size))?.with_kinds(stage.lamp_kinds);
        let rhythms = stage.lamp_kinds.rhythms;
        let volume = stage.volume(gpu, layout)?;
        let field = ProbeField::with_rhythms(gpu, volume, probes, rhythms)?;
        let faces = SurfaceCache::new(gpu, probes, rhythms)?;
        let scene = scene(&stage, &view, &lights);
        let wanted = Wanted::default();
        let subjects = Subjects {
            field: &field,
            cache: &faces,
            lights: &lights,
            bodies: &stage.voxels.bodies,
        };
        let passes = Passes::new(gpu, size, subjects, wanted, &scene)?;
        Ok(Self {
            stage,
            size,
            frames: 0,
            view,
            lights,
            gain: CommonGain::default(),
            resting: RestingLamps::default(),
            ranks: LampRanks::default(),
            recent_lights: RecentLights::default(),
            buried: BuriedLamps::default(),
            field,
            faces,
            passes,
            order: FrameOrder::default(),
            antialiasing: Antialiasing::default(),
            bits: DrawnBits::default(),
            drawn: Drawn {
                size,
                body_tiles: [0; 4],
                smoothed: None,
                is_finished: false,
            },
        })
    }

    /// Records one frame. The shot's size must be the frame's.
    pub fn record(
        &mut self,
        gpu: &Gpu,
        recorder: &mut Recorder<'_>,
        shot: &Shot,
        lights: &Lights,
        probes: &ProbeParameters,
    ) {
        debug_assert_eq!(shot.size, self.size, "the shot's size is the frame's");
        let brightest = self.stage.materials.brightest;
        let probes = &ProbeParameters {
            warmup_frames: warmup_frames(probes.warmup_frames, brightest),
            ..probes.clone()
        };
        let bodies = &self.stage.voxels.bodies;
        bodies.set_time(gpu, shot.time_s);
        let bodies_moved = bodies.begin_frame(gpu);
        if bodies_moved > 0.0 {
            self.antialiasing.move_bodies();
        }
        let inspected = self.passes.inspect.wanted;
        let is_warming = self.frames < probes.warmup_frames;
        let jittered = (self.antialiasing).next(shot, &inspected, Some(lights), is_warming);
        let emits = self.stage.emits();
        let told = self.lights.kinds().rhythms;
        let origin = self.stage.voxels.origin;
        let burials = self.buried.follow(lights, &self.stage.solid, origin);
        let is_dark = burials.are_total && !emits && lights.sky.is_dark();
        let LightsKept {
            lights,
            gain,
            rhythms,
        } = self.gain.keep(lights, emits, told);
        let gain = if is_dark { gain * 0.0 } else { gain };
        let light_change = self.recent_lights.change(&lights);
        let of_bodies = change_of_bodies(bodies_moved);
        let light_change = light_change.max(of_bodies).max(burials.change);
        self.field.end_growth(gpu);
        if self
            .field
            .follow(shot.camera.position, u64::from(self.frames))
        {
            self.frames = 0;
            self.resting.forget();
            self.ranks.forget();
            self.field.changes.forget_edits();
            self.faces.forget(&mut recorder.encoder);
        }
        if self.frames == 0 {
            self.lights.forget(&mut recorder.encoder);
        }
        // Frames of the surface cache are numbered from 1.
        let still_since = self.resting.follow(&lights, self.frames + 1);
        let ranked = self.ranks.follow(&lights, &still_since, self.frames + 1);
        if bodies_moved >= BODY_JUMP {
            self.field.changes.bodies_jump(self.frames);
        }
        self.field.changes.begin_frame(light_change, self.frames);
        let of_occlusion = OcclusionFrame {
            lights: &lights,
            still_since: &still_since,
            eye_ws: shot.camera.position.as_dvec3(),
            shadows: shot.shadows,
            frame: self.frames,
            shows_edit: self.field.changes.shown_first().is_some(),
        };
        (self.field.occlusion_mut()).begin_frame(gpu, probes, &of_occlusion);
        let lamps_have_changed = ranked.is_new || still_since.contains(&(self.frames + 1));
        // New lists have other lamps in their slots.
        if self.frames == 0 || ranked.is_new || light_change >= GREAT_ALERT {
            bodies.forget_shafts(gpu);
        }
        let sight_changes = lamps_have_changed || self.field.changes.shown_first().is_some();
        let shadows = CellShadows::of_frame(lights.lamps.len(), sight_changes, self.frames);
        let of_frame = LightsOfFrame {
            gain,
            rhythms,
            still_since,
            brightest: ranked.brightest,
            list_frame: ranked.made_in,
            keeps_slots: ranked.keeps_slots,
            shadows_known: shadows.are_known,
        };
        self.order.begin_frame(&shot.camera, self.frames);
        self.lights.set(gpu, &lights, &of_frame);
        let changes_greatly = self.field.changes.are_great(self.frames);
        let repeats = self.field.changes.repeats().great_since().is_some();
        (self.lights).begin_frame(gpu, &mut recorder.encoder, &lights, repeats);
        self.recent_lights.keep(lights);
        self.field
            .begin_frame(gpu, probes, u64::from(shot.seed), u64::from(self.frames));
        let is_settled = SurfaceCache::is_settled(probes, self.frames);
        let is_calm = is_settled && !changes_greatly;
        let shades_early = self.order.shades_early(is_calm);
        self.look(gpu, shot, jittered.as_ref(), shades_early);
        let next = NextFrame {
            size: shot.size,
            seed: shot.seed,
            age: self.frames,
            is_cut: self.order.is_cut(self.frames),
            changes: &self.field.changes,
            steadiness: self.recent_lights.steadiness(),
        };
        // Fewer pixels list fewer faces. Whether a face is large enough is a question of the shown pixels.
        let rays_per_pixel = self.rays_per_pixel();
        let of_faces = &ProbeParameters {
            face_share: probes.face_share * rays_per_pixel,
            face_pixels: probes.face_pixels * rays_per_pixel.sqrt(),
            ..probes.clone()
        };
        self.faces.begin_frame(gpu, of_faces, &next);
        let update = Update {
            lists_lamps: ranked.is_new,
            examines_shadows: shadows.are_examined,
            places_probes: self.field.misplaced(),
            marks_visibility: self.field.exact(),
            has_fresh: self.field.fresh() > 0,
            asks_faces: self
                .order
                .asks_faces(self.frames, sight_changes, bodies_moved > 0.0),
            moves_bodies: bodies_moved > 0.0,
            finds_body_cells: bodies_moved > 0.0 || self.frames == 0,
            finds_shafts: bodies_moved > 0.0 || lamps_have_changed || self.frames == 0,
            follows_change: is_settled && changes_greatly,
            estimates_early: is_calm,
            shades_early,
            bounces: self.field.changes.repeats().bounces(),
        };
        self.field.set_placed();
        self.passes.record(recorder, update, shot, self.drawn);
        self.frames += 1;
    }

    /// Sets what the next pictures show of the probes themselves. Must be called before the first picture of view
    /// [`View::States`](crate::world::View::States).
    ///
    /// # Errors
    /// [`FrameError`] for a layer that does not exist, and when the adapter cannot hold the buffers; the frame is then
    /// unchanged.
    pub fn inspect(&mut self, gpu: &Gpu, wanted: Inspection) -> Result<(), FrameError> {
        if wanted != self.passes.inspect.wanted {
            let scene = scene(&self.stage, &self.view, &self.lights);
            let offer = offer(&self.field, &self.faces, &scene);
            let Passes {
                camera_rays, shade, ..
            } = &self.passes;
            self.passes.inspect =
                Inspect::new(gpu, wanted, camera_rays, shade, &self.field, &offer)?;
        }
        Ok(())
    }

    /// Frames since the probes were made.
    pub fn frames(&self) -> u32 {
        self.frames
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Makes the picture at another size; the probes keep their light.
    ///
    /// # Errors
    /// [`FrameError::Gpu`] when the adapter cannot hold it; the frame is then unchanged.
    pub fn resize(&mut self, gpu: &Gpu, size: [u32; 2]) -> Result<(), FrameError> {
        let scene = scene(&self.stage, &self.view, &self.lights);
        let wanted = Wanted {
            inspection: self.passes.inspect.wanted,
            smoothing: self.antialiasing.wanted,
            bits: self.bits.wanted,
        };
        self.passes = Passes::new(gpu, size, self.subjects(), wanted, &scene)?;
        self.size = size;
        self.order = FrameOrder::default();
        self.antialiasing.restart();
        self.drawn.smoothed = None;
        Ok(())
    }

    /// Follows an edit of the CPU's copy of the voxels.
    ///
    /// # Errors
    /// [`FrameError::Gpu`] when the adapter cannot hold the bricks; the frame is then unchanged.
    pub fn apply(&mut self, gpu: &Gpu, voxels: &Voxels, edit: &Edit) -> Result<(), FrameError> {
        let emitters = edit
            .region
            .and_then(|region| self.stage.emitters.known.after(voxels, region));
        if let Some(before) = self.stage.make_room(gpu, voxels, emitters.as_ref())?
            && let Err(error) = self.rebuild_passes(gpu)
        {
            self.stage.put_back(before);
            return Err(error);
        }
        self.stage.voxels.write(gpu, voxels, edit);
        self.stage.solid.follow(voxels, edit);
        self.buried.forget();
        if let Some(emitters) = emitters {
            self.stage.emitters.write(gpu, emitters);
        }
        if let Some((first, last)) = edit.region {
            let origin_ws = self.stage.voxels.origin;
            self.antialiasing.edit(first.to_array(), last.to_array());
            self.field
                .regrow(gpu, voxels, first.as_ivec3(), last.as_ivec3());
            self.field
                .changes
                .edit(first.as_ivec3(), last.as_ivec3(), origin_ws, self.frames);
        }
        Ok(())
    }

    /// Compiles and binds every pass again, as after an edit of the folder `shaders/`; the probes keep their light.
    ///
    /// # Errors
    /// [`FrameError::Gpu`] with the place; the frame is then unchanged.
    pub fn rebuild_passes(&mut self, gpu: &Gpu) -> Result<(), FrameError> {
        self.resize(gpu, self.size)
    }

    pub fn field(&self) -> &ProbeField {
        &self.field
    }

    fn subjects(&self) -> Subjects<'_> {
        Subjects {
            field: &self.field,
            cache: &self.faces,
            lights: &self.lights,
            bodies: &self.stage.voxels.bodies,
        }
    }

    /// The faces that have light of their own.
    pub fn faces(&self) -> &SurfaceCache {
        &self.faces
    }
}
