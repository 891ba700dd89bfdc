//! What happens in each frame of a condition, the same in every run: world time, the camera's path, edits.

use glam::{IVec3, Vec3};

use super::{
    super::super::Failure,
    spec::{BenchScene, Condition},
};
use crate::{
    frame::Frame,
    gpu::Gpu,
    reference::{
        flight_path::Path,
        march::{Outcome, Ray, march},
    },
    world::{Camera, voxels::Voxels},
};

/// Frames per second of world time.
pub const RATE: f64 = 60.0;
/// Speed of a flight (metres per second).
const SPEED: f32 = 10.0;
/// Longest path in metres, before it turns back.
const PATH_M: f32 = 200.0;
/// Turning speed of a camera that has no room to fly (degrees per second).
const TURN_DEG: f32 = 90.0;
/// Frames between two edits.
const EDIT_INTERVAL: u32 = 10;
/// Radius of the ball that is dug or built, in voxels.
const BALL_RADIUS: f32 = 2.0;

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
            Self::Flight { path, voxel_m } => path.at(SPEED / voxel_m * seconds as f32),
        }
    }
}

/// Edits balls where the camera looks, alternately digging and building, each at another place. As with a
/// player, the world keeps outgrowing its buffers.
pub struct Digging {
    voxels: Voxels,
    origin: IVec3,
    camera: Camera,
    /// Rays tried so far.
    count: u32,
    builds: bool,
}

impl Digging {
    pub fn new(scene: &BenchScene, voxels: &Voxels, camera: &Camera) -> Self {
        Self {
            voxels: voxels.clone(),
            origin: scene.world.origin,
            camera: camera.clone(),
            count: 0,
            builds: false,
        }
    }

    /// Edits the world if an edit is due in this frame.
    ///
    /// # Errors
    /// When the adapter cannot hold the bricks.
    pub fn step(&mut self, gpu: &Gpu, frame: &mut Frame, index: u32) -> Result<(), Failure> {
        if !index.is_multiple_of(EDIT_INTERVAL) {
            return Ok(());
        }
        let Some((centre, material)) = self.target() else {
            return Ok(());
        };
        let filling = if self.builds { material } else { 0 };
        self.builds = !self.builds;
        let edit = self.voxels.fill_sphere(centre, BALL_RADIUS, filling);
        Ok(frame.apply(gpu, &self.voxels, &edit)?)
    }

    /// Where the next of a fixed sequence of camera rays hits a solid voxel (grid space), and its material.
    fn target(&mut self) -> Option<(Vec3, u8)> {
        /// Rays tried before a camera counts as seeing nothing.
        const TRIES: u32 = 16;
        let basis = self.camera.basis(1.0);
        let origin = basis.origin - self.origin.as_dvec3();
        (0..TRIES).find_map(|_| {
            self.count += 1;
            // R2: the plastic number's additive recurrence covers the picture evenly (Roberts 2018).
            let n = f64::from(self.count);
            let [x, y] =
                [0.754_877_666_246_693, 0.569_840_290_998_053].map(|a| (0.5 + n * a) % 1.0);
            let [x, y] = [x, y].map(|share| 1.2 * (share - 0.5));
            let direction = basis.forward + basis.right * x + basis.up * y;
            let ray = Ray::new(origin, direction.normalize());
            match march(&self.voxels, &ray) {
                Outcome::Hit(hit) => Some((hit.position(&ray).as_vec3(), hit.material)),
                Outcome::Inside(_) | Outcome::Miss => None,
            }
        })
    }
}
