//! Probes that take the place of others while a world is shown.

use super::{Frame, FrameError, offers::Subjects, passes::Passes, stage::scene, values::Wanted};
use crate::{
    gpu::Gpu,
    lights::CommonGain,
    parameters::ProbeParameters,
    passes::{probes::ProbeField, surface_cache::SurfaceCache, view::Inspection},
    world::LayoutSpec,
};

impl Frame {
    /// Replaces the probes: another layout, or parameters that their buffers depend on. The view of an atlas ends.
    ///
    /// # Errors
    /// [`FrameError`] when the adapter cannot hold them; the frame is then unchanged.
    pub fn replace_probes(
        &mut self,
        gpu: &Gpu,
        layout: &LayoutSpec,
        probes: &ProbeParameters,
    ) -> Result<(), FrameError> {
        let rhythms = self.lights.kinds().rhythms;
        let volume = self.stage.volume(gpu, layout)?;
        let field = ProbeField::with_rhythms(gpu, volume, probes, rhythms)?;
        let faces = SurfaceCache::new(gpu, probes, rhythms)?;
        let scene = scene(&self.stage, &self.view, &self.lights);
        let wanted = Wanted {
            inspection: Inspection {
                atlas: None,
                ..self.passes.inspect.wanted
            },
            smoothing: self.antialiasing.wanted,
            bits: self.bits.wanted,
        };
        let subjects = Subjects {
            field: &field,
            cache: &faces,
            ..self.subjects()
        };
        self.passes = Passes::new(gpu, self.size, subjects, wanted, &scene)?;
        self.field = field;
        self.faces = faces;
        self.frames = 0;
        // New probes have no history that a change could make out of date.
        self.gain = CommonGain::default();
        self.resting.forget();
        self.ranks.forget();
        self.recent_lights.forget();
        self.buried.forget();
        self.antialiasing.restart();
        self.drawn.smoothed = None;
        Ok(())
    }
}
