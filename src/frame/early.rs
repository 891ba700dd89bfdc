//! What of a frame can begin before there is a device: the composition of its shaders.

use crate::{gpu::EarlyShaders, passes::scene::voxelise::Voxelise, world::World};

/// The shaders of every world's first frame, the longest first.
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

/// Those that the first frame of a world with bodies has besides, likewise.
const OF_BODIES: [&str; 6] = [
    "surface_cache/body_light",
    "surface_cache/body_lamps",
    "surface_cache/body_cells",
    "probes/cover",
    "surface_cache/body_shafts",
    "scene/publish_facts",
];

/// Begins to compose the shaders of every first frame.
pub fn begin_shaders() -> EarlyShaders {
    EarlyShaders::begin(&SHADERS)
}

/// Begins to compose the shaders that this world needs besides: the one that builds its voxels, and those of its bodies.
pub fn begin_world(shaders: &EarlyShaders, world: &World) {
    Voxelise::compose(shaders, world);
    if !world.bodies.bodies.is_empty() {
        for shader in OF_BODIES {
            shaders.compose(shader, &[]);
        }
    }
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

    /// All that begins is asked for by the first frame of a world.
    fn check(world: &str) {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(world);
        let world = file::load(&path, &Overrides::default()).expect("it loads");
        let shaders = begin_shaders();
        begin_world(&shaders, &world);
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

    #[test]
    fn a_first_frame_uses_all_that_begins_early() {
        check("worlds/minimal.ron");
    }

    #[test]
    fn a_first_frame_with_bodies_does_so_too() {
        check("worlds/cornell_turning.ron");
    }
}
