//! What the passes of a frame may bind by name.

use super::Stage;
use crate::{
    gpu::Offer,
    passes::{probes::ProbeField, scene::GpuLights, surface_cache::SurfaceCache},
};

/// What subjects offer to each other: the scene, the light of the probes, and the light of surfaces.
pub fn offer<'a>(
    field: &'a ProbeField,
    cache: &'a SurfaceCache,
    scene: &[(&'a str, wgpu::BindingResource<'a>)],
) -> Offer<'a> {
    let mut resources = scene.to_vec();
    resources.extend(field.resources());
    resources.extend(field.schedule_resources());
    resources.extend(cache.resources());
    let mut constants = field.gather_constants().to_vec();
    constants.extend(cache.constants());
    Offer {
        resources,
        constants,
    }
}

/// What every pass may bind by name.
pub fn resources<'a>(
    stage: &'a Stage,
    view: &'a wgpu::Buffer,
    lights: &'a GpuLights,
) -> Vec<(&'static str, wgpu::BindingResource<'a>)> {
    let mut all = stage.voxels.resources().to_vec();
    all.extend(stage.materials.resources());
    all.extend(stage.emitters.resources());
    all.extend(lights.resources());
    all.push(("view", view.as_entire_binding()));
    all
}
