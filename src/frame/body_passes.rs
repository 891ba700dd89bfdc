//! What a frame finds out about its bodies.

use std::thread;

use crate::{
    gpu::{Gpu, GpuError, Offer, Recorder, made},
    passes::{
        probes::{ProbeField, body_light::BodyLight, cover::ProbeCover},
        scene::GpuBodies,
        surface_cache::body_shafts::BodyShafts,
    },
};

pub(super) struct BodyPasses {
    cover: ProbeCover,
    light: BodyLight,
    shafts: BodyShafts,
    bodies: GpuBodies,
}

impl BodyPasses {
    /// `None` where there are no bodies. `offer` is that of the scene and the probes.
    pub fn new(
        gpu: &Gpu,
        bodies: &GpuBodies,
        field: &ProbeField,
        offer: &Offer<'_>,
    ) -> Result<Option<Self>, GpuError> {
        if !bodies.exist() {
            return Ok(None);
        }
        thread::scope(|threads| {
            let cover = threads.spawn(|| ProbeCover::new(gpu, field, offer));
            let light = threads.spawn(|| BodyLight::new(gpu, offer));
            let shafts = BodyShafts::new(gpu, bodies.cells(), offer)?;
            Ok(Some(Self {
                cover: made(cover)?,
                light: made(light)?,
                shafts,
                bodies: bodies.clone(),
            }))
        })
    }

    /// Which probes bodies cover.
    pub fn cover(&self, recorder: &mut Recorder<'_>) {
        self.cover.record(recorder);
    }

    /// The light of bodies and, if they or the lamps have moved, which lamps they may hide.
    pub fn record(&self, recorder: &mut Recorder<'_>, finds_shafts: bool) {
        self.light.record(recorder, self.bodies.lit_faces());
        if finds_shafts {
            self.shafts.record(recorder);
        }
    }

    /// Hands over what [`record`](Self::record) has found, once no shared pass is open.
    pub fn publish(&self, recorder: &mut Recorder<'_>) {
        self.bodies.publish_facts(&mut recorder.encoder);
    }
}
