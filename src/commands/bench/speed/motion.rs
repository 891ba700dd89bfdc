//! The camera's path in each condition, the same in every run.

use super::{
    super::super::dynamics::{FLIGHT_SPEED, TURN_DEG},
    spec::{BenchScene, Condition},
};
use crate::{
    reference::flight_path::Path,
    world::{Camera, voxels::Voxels},
};

/// Longest path in metres, before it turns back.
const PATH_M: f32 = 200.0;

/// The camera's path.
pub enum Track {
    Rest(Camera),
    Turn(Camera),
    Flight { path: Path, voxel_m: f32 },
}

impl Track {
    /// A path through the world from a camera.
    pub fn of(condition: Condition, scene: &BenchScene, voxels: &Voxels, camera: &Camera) -> Self {
        if condition != Condition::Flight {
            return Self::Rest(camera.clone());
        }
        let voxel_m = scene.world.voxel_m;
        let cameras = std::slice::from_ref(camera);
        match Path::new(&scene.world, voxels, cameras, PATH_M / voxel_m) {
            Ok(path) => Self::Flight { path, voxel_m },
            // The camera faces a wall.
            Err(_) => Self::Turn(camera.clone()),
        }
    }

    /// The camera after this many seconds.
    pub fn at(&self, seconds: f64) -> Camera {
        match self {
            Self::Rest(camera) => camera.clone(),
            Self::Turn(camera) => Camera {
                yaw_deg: camera.yaw_deg + TURN_DEG * seconds as f32,
                ..camera.clone()
            },
            Self::Flight { path, voxel_m } => path.at(FLIGHT_SPEED / voxel_m * seconds as f32),
        }
    }
}
