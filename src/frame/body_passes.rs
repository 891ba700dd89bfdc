//! What a frame finds out about its bodies.

use std::thread;

use super::values::Update;
use crate::{
    gpu::{Gpu, GpuError, Offer, Recorder, made},
    passes::{
        probes::{ProbeField, cover::ProbeCover},
        scene::{GpuBodies, publish_facts::PublishFacts},
        surface_cache::{
            SurfaceCache, body_cells::BodyCells, body_lamps::BodyLamps, body_light::BodyLight,
            body_shafts::BodyShafts,
        },
    },
};

pub(super) struct BodyPasses {
    cover: ProbeCover,
    light: BodyLight,
    cells: BodyCells,
    lamps: BodyLamps,
    shafts: BodyShafts,
    publish: PublishFacts,
    bodies: GpuBodies,
}

impl BodyPasses {
    /// `None` where there are no bodies. `offer` is that of all subjects.
    pub fn new(
        gpu: &Gpu,
        bodies: &GpuBodies,
        field: &ProbeField,
        cache: &SurfaceCache,
        offer: &Offer<'_>,
    ) -> Result<Option<Self>, GpuError> {
        if !bodies.exist() {
            return Ok(None);
        }
        thread::scope(|threads| {
            let cover = threads.spawn(|| ProbeCover::new(gpu, field, offer));
            let light = threads.spawn(|| BodyLight::new(gpu, cache, offer));
            let cells = threads.spawn(|| BodyCells::new(gpu, offer));
            let lamps = threads.spawn(|| BodyLamps::new(gpu, offer));
            let shafts = BodyShafts::new(gpu, offer)?;
            Ok(Some(Self {
                cover: made(cover)?,
                light: made(light)?,
                cells: made(cells)?,
                lamps: made(lamps)?,
                shafts,
                publish: PublishFacts::new(gpu, bodies)?,
                bodies: bodies.clone(),
            }))
        })
    }

    /// Which probes bodies cover.
    pub fn cover(&self, recorder: &mut Recorder<'_>) {
        self.cover.record(recorder);
    }

    /// Which cells bodies may touch.
    pub fn find_cells(&self, recorder: &mut Recorder<'_>) {
        self.cells.record(recorder, self.bodies.near_cells());
    }

    /// The light of bodies; which lamps they see, and which they may hide, if that may have changed.
    pub fn record(&self, recorder: &mut Recorder<'_>, update: &Update) {
        self.light.record(recorder, self.bodies.lit_faces());
        if update.finds_shafts {
            self.shafts.record(recorder, self.bodies.shaded_places());
        }
        if (update.finds_shafts || update.asks_faces)
            && let Some(touched) = self.bodies.touched_cells()
        {
            self.lamps.record(recorder, touched);
        }
    }

    /// Hands over what [`record`](Self::record) has found.
    pub fn publish(&self, recorder: &mut Recorder<'_>) {
        self.publish.record(recorder);
    }
}
