//! A world that is shown, and a body in it, for tests.

use std::{path::Path, sync::Arc};

use glam::{UVec3, Vec3};

use super::{Choice, Viewport};
use crate::{
    gpu::{Gpu, ShaderChecks},
    parameters::Parameters,
    world::{
        self,
        bodies::{BodyModel, PlacedBody, WholeBody},
        file::Overrides,
    },
};

/// `minimal.ron` in a picture of 8 × 8 pixels.
pub fn shown() -> Viewport {
    shown_as(&Overrides::default())
}

/// The same with some values of the world file replaced.
pub fn shown_as(overrides: &Overrides) -> Viewport {
    let gpu = Gpu::open(None, ShaderChecks::Checked).expect("the tests need a Vulkan device");
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("worlds/minimal.ron");
    let world = world::file::load(&path, overrides).expect("it loads");
    let mut parameters = Parameters::default();
    parameters.probes.rays = 8;
    let choice = Choice {
        parameters,
        layout: String::new(),
        size: [8, 8],
        traced: false,
    };
    Viewport::new(gpu, &path, world, choice).expect("it fits")
}

/// A body of one voxel.
pub fn body_at(corner: Vec3) -> WholeBody {
    WholeBody::placed(&PlacedBody {
        name: "placed 1".into(),
        model: Arc::new(BodyModel {
            size: UVec3::ONE,
            materials: vec![1],
        }),
        corner,
    })
}
