//! What a frame draws of the probes themselves. Each pass is made when it is requested.

use super::{FrameError, values::Drawn};
use crate::{
    gpu::{Gpu, Offer, Recorder},
    passes::{
        probes::ProbeField,
        view::{
            Inspection, atlas_view::AtlasView, camera_rays::CameraRays, probe_draw::ProbeDraw,
            shade::Shade, state_view::StateView,
        },
    },
    world::View,
};

#[derive(Default)]
pub(super) struct Inspect {
    pub wanted: Inspection,
    states: Option<StateView>,
    probes: Option<ProbeDraw>,
    atlas: Option<AtlasView>,
}

impl Inspect {
    pub fn new(
        gpu: &Gpu,
        wanted: Inspection,
        camera_rays: &CameraRays,
        shade: &Shade,
        field: &ProbeField,
        offer: &Offer<'_>,
    ) -> Result<Self, FrameError> {
        let mut made = Self {
            wanted,
            ..Self::default()
        };
        let surfaces = &camera_rays.surfaces;
        if wanted.view == View::States {
            made.states = Some(StateView::new(
                gpu,
                &shade.hdr,
                surfaces,
                field.atlas().slots,
                field.memory().ambient_cubes,
                offer,
            )?);
        }
        if let Some(layer) = wanted.atlas {
            layer.check(field.atlas())?;
            let [width, height, _] = field.atlas().layer_extent(layer.map.texels(field.atlas()));
            let layer_extent = [width, height];
            made.atlas = Some(AtlasView::new(gpu, layer, &shade.hdr, layer_extent, offer)?);
        } else if let Some(colour) = wanted.probes {
            let hdr = &shade.hdr;
            made.probes = Some(ProbeDraw::new(
                gpu,
                colour,
                hdr,
                surfaces,
                field.atlas().slots,
                offer,
            )?);
        }
        Ok(made)
    }

    /// Records the pass that makes a picture of what the camera rays hit. It shows `view`.
    pub fn shade(&self, recorder: &mut Recorder<'_>, shade: &Shade, view: View, drawn: Drawn) {
        // Runs below an atlas too: pixels request probes, and viewing the atlas must not put the probes to sleep.
        if view == View::States {
            let states = self.states.as_ref();
            let states = states.expect("`Frame::inspect` comes before a view of states");
            states.record(recorder);
        } else {
            shade.record(recorder, drawn.size, drawn.body_tiles);
        }
    }

    /// Whether anything but pass `view/shade` draws on pictures that show `view`.
    pub fn draws(&self, view: View) -> bool {
        view == View::States || self.probes.is_some() || self.atlas.is_some()
    }

    /// Draws over the picture.
    pub fn draw(&self, recorder: &mut Recorder<'_>) {
        if let Some(probes) = &self.probes {
            probes.record(recorder);
        }
        if let Some(atlas) = &self.atlas {
            atlas.record(recorder);
        }
    }

    /// Bytes of GPU memory, for a picture of this size.
    pub fn bytes(&self, size: [u32; 2]) -> u64 {
        let states = self.states.as_ref().map_or(0, |states| states.cubes.size());
        states + u64::from(self.probes.is_some()) * ProbeDraw::bytes(size)
    }
}
