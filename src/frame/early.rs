//! What of a frame can begin before there is a device: the composition of its shaders.

use crate::{gpu::EarlyShaders, passes::scene::voxelise::Voxelise, world::World};

/// The shaders of every world's first frame, the longest first. Others, as those of a world's bodies, are composed
/// when their passes are made.
pub(super) const SHADERS: [&str; 19] = [
    "view/shade",
    "probes/trace",
    "surface_cache/trace",
    "surface_cache/lamps",
    "surface_cache/resolve",
    "surface_cache/estimate",
    "surface_cache/allocate",
    "view/camera_rays",
    "probes/visibility",
    "probes/seed",
    "probes/classify",
    "probes/blend",
    "probes/schedule",
    "surface_cache/cell_shadows",
    "scene/lamp_lists",
    "scene/distances",
    "surface_cache/place_requested",
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

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::{
        frame::{Frame, Stage},
        gpu::{Gpu, ShaderChecks},
        parameters::Parameters,
        world::file::{self, Overrides},
    };

    #[test]
    fn a_first_frame_uses_all_that_begins_early() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("worlds/minimal.ron");
        let world = file::load(&path, &Overrides::default()).expect("it loads");
        let shaders = begin_shaders();
        begin_voxels(&shaders, &world);
        let gpu = Gpu::open(None, ShaderChecks::Checked).expect("the tests need a Vulkan device");
        let gpu = gpu.with_early(shaders.clone());
        assert!(!shaders.is_used_up());
        let stage = Stage::build(&gpu, &world).expect("it fits");
        let Parameters {
            probes, picture, ..
        } = Parameters::default();
        let frame = Frame::new(&gpu, stage, &world.layouts[0], &probes, [8, 8]);
        let mut frame = frame.expect("it fits");
        frame.antialias(&gpu, &picture).expect("it fits");
        assert!(shaders.is_used_up());
    }
}
