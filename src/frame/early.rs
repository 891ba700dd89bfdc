//! What of a frame can begin before there is a device: the composition of its shaders.

use crate::{gpu::EarlyShaders, passes::scene::voxelise::Voxelise, world::World};

/// The shaders of every world's first frame, the longest first. Others, as those of a world's bodies, are composed
/// when their passes are made.
pub(super) const SHADERS: [&str; 16] = [
    "view/shade",
    "probes/trace",
    "surface_cache/trace",
    "surface_cache/lamps",
    "surface_cache/resolve",
    "surface_cache/allocate",
    "view/camera_rays",
    "probes/visibility",
    "probes/seed",
    "probes/classify",
    "probes/blend",
    "probes/schedule",
    "scene/lamp_lists",
    "scene/distances",
    "view/antialias",
    "view/tonemap",
];

/// Begins to compose the shaders of the first frame.
pub fn begin_shaders() -> EarlyShaders {
    EarlyShaders::begin(&SHADERS)
}

/// Begins to compose the shader that builds this world's voxels.
pub fn begin_voxels(shaders: &EarlyShaders, world: &World) {
    Voxelise::compose(shaders, world);
}
