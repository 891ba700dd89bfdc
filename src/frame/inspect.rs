//! What a frame draws of the probes themselves: made when it is asked for.

use super::FrameError;
use crate::{
    gpu::{Bindings, Gpu, Recorder},
    passes::{
        Inspection, ProbeField, ViewMode, atlas_view::AtlasView, camera_rays::CameraRays,
        probe_draw::ProbeDraw, probe_paint::ProbePaint, shade::Shade,
    },
};

#[derive(Default)]
pub(super) struct Inspect {
    pub wanted: Inspection,
    /// With what pass `shade` binds to gather colours in place of light.
    states: Option<(ProbePaint, Bindings)>,
    probes: Option<ProbeDraw>,
    atlas: Option<AtlasView>,
}

impl Inspect {
    /// `resources` are those of every pass.
    pub fn new(
        gpu: &Gpu,
        wanted: Inspection,
        camera_rays: &CameraRays,
        shade: &Shade,
        field: &ProbeField,
        resources: &[(&str, wgpu::BindingResource<'_>)],
    ) -> Result<Self, FrameError> {
        let mut made = Self {
            wanted,
            ..Self::default()
        };
        let surfaces = &camera_rays.surfaces;
        if wanted.view == ViewMode::States {
            let paint = ProbePaint::new(gpu, field)?;
            let bindings = shade.bind(gpu, surfaces, field, &paint.cubes, resources);
            made.states = Some((paint, bindings));
        }
        if let Some(layer) = wanted.atlas {
            layer.check(field)?;
            made.atlas = Some(AtlasView::new(gpu, layer, &shade.hdr, field, resources)?);
        } else if let Some(colour) = wanted.probes {
            let hdr = &shade.hdr;
            made.probes = Some(ProbeDraw::new(
                gpu, colour, hdr, surfaces, field, resources,
            )?);
        }
        Ok(made)
    }

    /// Records what lies between the camera rays and the tone mapper. `mode` is the view's.
    pub fn record(&self, recorder: &mut Recorder<'_>, shade: &Shade, mode: ViewMode) {
        // Also below an atlas: pixels ask for probes, and looking at them must not put them to sleep.
        if mode == ViewMode::States {
            let states = self.states.as_ref();
            let (paint, bindings) = states.expect("`Frame::inspect` comes before a view of states");
            paint.record(recorder);
            shade.record_with(recorder, bindings);
        } else {
            shade.record(recorder);
        }
        if let Some(probes) = &self.probes {
            probes.record(recorder);
        }
        if let Some(atlas) = &self.atlas {
            atlas.record(recorder);
        }
    }

    /// Bytes of GPU memory, for a picture of this size.
    pub fn bytes(&self, size: [u32; 2]) -> u64 {
        let states = self
            .states
            .as_ref()
            .map_or(0, |(paint, _)| paint.cubes.size());
        states + u64::from(self.probes.is_some()) * ProbeDraw::bytes(size)
    }
}
