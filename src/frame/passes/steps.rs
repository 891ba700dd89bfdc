//! The steps of a frame.

use super::{
    super::values::{
        ActiveList, ClassifiedProbes, Drawn, FaceEstimates, FaceLight, FaceRays, ListedFaces,
        PlacedProbes, ProbeLight, ProbeRays, Radiance, SightedProbes, Surfaces, Update,
    },
    Passes,
};
use crate::{
    gpu::Recorder,
    passes::view::{Shot, bits::Bits},
};

/// One method for each step of a frame: its arguments are what the step reads of this frame, its result is what it
/// writes. A value exists only once its pass is recorded, so the compiler checks the order of the passes.
impl Passes {
    /// The lists stay valid from the last frame where no lamp has moved.
    pub(super) fn list_lamps(&self, recorder: &mut Recorder<'_>, is_needed: bool) {
        if is_needed {
            self.lamp_lists.record(recorder);
        }
    }

    /// What is known of cells stays valid from the last frame where no lamp has moved and no voxel was edited. Reads which cells
    /// pixels of the last frames have seen.
    pub(super) fn examine_shadows(&self, recorder: &mut Recorder<'_>, is_needed: bool) {
        if is_needed {
            self.cell_shadows.record(recorder);
        }
    }

    /// Which probes bodies cover. New probes, and those that were moved, must have been placed.
    pub(super) fn cover_probes(&self, recorder: &mut Recorder<'_>, is_needed: bool) {
        if let (Some(bodies), true) = (&self.bodies, is_needed) {
            bodies.cover(recorder);
        }
    }

    /// Which cells bodies may touch: the list stays valid from the last frame where none has moved.
    pub(super) fn find_body_cells(&self, recorder: &mut Recorder<'_>, is_needed: bool) {
        if let (Some(bodies), true) = (&self.bodies, is_needed) {
            bodies.find_cells(recorder);
        }
    }

    /// Probes that are new, were moved, or are near an edit. The places of all other probes stay valid from the last frame.
    pub(super) fn classify_probes(&self, recorder: &mut Recorder<'_>) -> ClassifiedProbes {
        self.classify.record(recorder);
        if let Some(walk) = &self.walk {
            walk.record_begin(recorder);
        }
        ClassifiedProbes
    }

    /// Which surfaces these probes see.
    pub(super) fn look_around(
        &self,
        recorder: &mut Recorder<'_>,
        update: Update,
        _: ClassifiedProbes,
    ) -> SightedProbes {
        if update.places_probes && update.marks_visibility {
            self.visibility.record_look(recorder);
        }
        SightedProbes
    }

    /// What their back-side probes see, the light of probes that are new, and which probes bodies cover then.
    pub(super) fn place_probes(
        &self,
        recorder: &mut Recorder<'_>,
        update: Update,
        _: SightedProbes,
    ) -> PlacedProbes {
        if update.places_probes && update.marks_visibility {
            self.visibility.record_look_back(recorder);
        }
        if update.places_probes && update.has_fresh {
            self.seed.record(recorder);
        }
        self.cover_probes(recorder, update.places_probes);
        // Probes that walk may have moved at the end of any frame.
        if let Some(forget_hits) = &self.forget_hits
            && (update.places_probes || self.walk.is_some())
        {
            forget_hits.record(recorder);
        }
        PlacedProbes
    }

    /// The light of bodies; which lamps they see and may hide.
    pub(super) fn examine_bodies(
        &self,
        recorder: &mut Recorder<'_>,
        update: &Update,
        _: &PlacedProbes,
    ) {
        if let Some(bodies) = &self.bodies {
            bodies.record(recorder, update);
        }
    }

    /// By what the light of faces is multiplied that were lit before.
    pub(super) fn find_gains(&self, recorder: &mut Recorder<'_>) {
        if let Some(gains) = &self.gains {
            gains.record(recorder);
        }
    }

    pub(super) fn trace_camera(&self, recorder: &mut Recorder<'_>, drawn: Drawn) -> Surfaces {
        self.camera_rays.record(recorder, drawn.size);
        Surfaces
    }

    /// Which lamps the faces see that the last frame listed: most of them are in this picture, too.
    pub(super) fn ask_faces(&self, recorder: &mut Recorder<'_>, is_needed: bool) {
        if self.uses_cache && is_needed {
            self.face_lamps.record(recorder);
        }
    }

    /// Reads the requests of the last frame.
    pub(super) fn list_probes(&self, recorder: &mut Recorder<'_>, _: PlacedProbes) -> ActiveList {
        self.schedule.record(recorder);
        ActiveList
    }

    /// Lists the visible faces, which get places in the table, and those that rays of the last frame requested.
    pub(super) fn list_faces(&self, recorder: &mut Recorder<'_>, _: &Surfaces) -> ListedFaces {
        if self.uses_cache {
            self.allocate.record(recorder);
        }
        ListedFaces
    }

    /// Reads the light that probes and faces gave before: each update adds one bounce.
    pub(super) fn trace_probes(&self, recorder: &mut Recorder<'_>, _: &ActiveList) -> ProbeRays {
        self.probe_trace.record(recorder);
        ProbeRays
    }

    /// Reads the light of probes, in this frame or in the last one, and that of faces in the last one.
    pub(super) fn trace_faces(
        &self,
        recorder: &mut Recorder<'_>,
        _: &ListedFaces,
        _: &ProbeLight,
    ) -> FaceRays {
        if self.uses_cache {
            self.surface_trace.record(recorder);
        }
        FaceRays
    }

    /// What the probes tell of the light of faces, in this frame or in the last one.
    pub(super) fn estimate_faces(
        &self,
        recorder: &mut Recorder<'_>,
        _: &ListedFaces,
        _: &ProbeLight,
    ) -> FaceEstimates {
        if self.uses_cache {
            self.estimate.record(recorder);
        }
        FaceEstimates
    }

    /// Gives places to the faces that the rays request.
    pub(super) fn place_requested(&self, recorder: &mut Recorder<'_>, _: &FaceRays) {
        if self.uses_cache {
            self.place_requested.record(recorder);
        }
    }

    pub(super) fn blend_probes(
        &self,
        recorder: &mut Recorder<'_>,
        _: &ActiveList,
        _: ProbeRays,
    ) -> ProbeLight {
        (self.occlusion.0.iter()).for_each(|rays| rays.record(recorder));
        (self.occlusion.1.iter()).for_each(|blend| blend.record(recorder));
        if let Some(distances) = &self.blend_distances {
            distances.record(recorder);
        }
        self.blend_light(recorder);
        ProbeLight
    }

    fn blend_light(&self, recorder: &mut Recorder<'_>) {
        self.blend.record(recorder);
        if let Some(rhythms) = &self.rhythms {
            rhythms.record(recorder);
        }
    }

    /// One bounce more: the probes' rays are traced again, by the light that the probes give now. Distances stay the same.
    pub(super) fn bounce(
        &self,
        recorder: &mut Recorder<'_>,
        active: &ActiveList,
        _: ProbeLight,
    ) -> ProbeLight {
        self.schedule.record_repeat(recorder);
        self.trace_probes(recorder, active);
        self.blend_light(recorder);
        ProbeLight
    }

    /// Probes that walk go on: after all their rays of this frame.
    pub(super) fn move_probes(&self, recorder: &mut Recorder<'_>, _: &ProbeLight) {
        if let Some(walk) = &self.walk {
            walk.record(recorder);
        }
    }

    pub(super) fn resolve_faces(
        &self,
        recorder: &mut Recorder<'_>,
        _: ListedFaces,
        _: &FaceRays,
        _: FaceEstimates,
    ) -> FaceLight {
        if self.uses_cache {
            self.resolve.record(recorder);
        }
        FaceLight
    }

    /// Writes the light that arrives at the camera, or a view of data. Leaves requests for the next frame.
    pub(super) fn shade(
        &self,
        recorder: &mut Recorder<'_>,
        _: &Surfaces,
        _: &(ProbeLight, FaceLight),
        shot: &Shot,
        drawn: Drawn,
    ) -> Radiance {
        self.inspect.shade(recorder, &self.shade, shot.view, drawn);
        Radiance
    }

    /// Draws what flies and the bulbs of lamps before the surfaces.
    pub(super) fn draw_bits(
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
    pub(super) fn inspect(&self, recorder: &mut Recorder<'_>, radiance: Radiance) -> Radiance {
        self.inspect.draw(recorder);
        radiance
    }

    /// Averages jittered pictures; of those with fewer pixels than are shown it makes one of all.
    pub(super) fn antialias(
        &self,
        recorder: &mut Recorder<'_>,
        radiance: Radiance,
        drawn: Drawn,
    ) -> Radiance {
        if let (Some(pass), Some(which)) = (&self.antialias, drawn.smoothed) {
            pass.record(recorder, which);
        }
        radiance
    }

    /// Shows the picture, unless the pass before has shown it.
    pub(super) fn tonemap(&self, recorder: &mut Recorder<'_>, _: Radiance, drawn: Drawn) {
        if drawn.smoothed.is_none() && !drawn.is_finished {
            self.tonemap.record(recorder);
        }
    }
}
