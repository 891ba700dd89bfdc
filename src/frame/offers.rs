//! What the passes of a frame may take by name from each other.

use crate::{
    gpu::Offer,
    passes::{
        probes::ProbeField,
        scene::{GpuBodies, GpuLights},
        surface_cache::SurfaceCache,
    },
};

/// What subjects offer to each other: the scene, the light of the probes, and the light of surfaces.
pub fn offer<'a>(field: &'a ProbeField, cache: &'a SurfaceCache, scene: &Offer<'a>) -> Offer<'a> {
    let mut resources = scene.resources.clone();
    resources.extend(field.resources());
    resources.extend(field.schedule_resources());
    resources.extend(field.occlusion().resources());
    resources.extend(cache.resources());
    let mut constants = scene.constants.clone();
    constants.extend(field.gather_constants());
    constants.extend(field.occlusion().constants());
    constants.extend(cache.constants());
    Offer {
        resources,
        constants,
    }
}

/// What the passes are about, besides the scene.
#[derive(Clone, Copy)]
pub(super) struct Subjects<'a> {
    pub field: &'a ProbeField,
    pub cache: &'a SurfaceCache,
    pub lights: &'a GpuLights,
    pub bodies: &'a GpuBodies,
}
