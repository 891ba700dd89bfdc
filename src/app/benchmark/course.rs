//! Where the camera of the benchmark goes.

use crate::{
    reference::flight_path::Path,
    world::{Camera, World, voxels::Voxels},
};

/// Fastest flight (metres per second).
const MOST_SPEED: f32 = 20.0;
/// Farthest flight from a single camera (metres).
const MOST_LENGTH: f32 = 200.0;

/// A camera for every moment of the benchmark.
#[derive(Debug)]
pub enum Course {
    /// Through all cameras of the world and back.
    Cameras(Path),
    /// Straight ahead from one camera and back.
    Ahead(Path),
    /// Once around on the spot.
    Turn(Camera),
}

impl Course {
    /// Through the cameras of the world if they see each other, else straight ahead from `camera`. If `camera`
    /// faces a wall, it turns around on the spot.
    pub fn new(world: &World, voxels: &Voxels, camera: &Camera) -> Self {
        let length = MOST_LENGTH / world.voxel_m;
        let path = |cameras: &[Camera]| Path::new(world, voxels, cameras, length).ok();
        if world.cameras.len() > 1
            && let Some(path) = path(&world.cameras)
        {
            return Self::Cameras(path);
        }
        match path(std::slice::from_ref(camera)) {
            Some(path) => Self::Ahead(path),
            None => Self::Turn(camera.clone()),
        }
    }

    /// The camera after `elapsed_s` of `total_s` seconds. It goes there and back at most once.
    pub fn at(&self, elapsed_s: f64, total_s: f64, voxel_m: f32) -> Camera {
        match self {
            Self::Cameras(path) | Self::Ahead(path) => {
                let speed = (2.0 * path.length() / total_s as f32).min(MOST_SPEED / voxel_m);
                path.at(speed * elapsed_s as f32)
            }
            Self::Turn(camera) => {
                let turned = 360.0 * (elapsed_s / total_s) as f32;
                let yaw_deg = (camera.yaw_deg + turned + 180.0).rem_euclid(360.0) - 180.0;
                Camera {
                    yaw_deg,
                    ..camera.clone()
                }
            }
        }
    }

    /// For a person, after "20 s".
    pub fn describe(&self) -> &'static str {
        match self {
            Self::Cameras(_) => "through the world's cameras and back",
            Self::Ahead(_) => "straight on from the camera and back",
            Self::Turn(_) => "around on the spot",
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    fn camera(name: &str, position: Vec3) -> Camera {
        Camera {
            name: name.into(),
            position,
            yaw_deg: 0.0,
            pitch_deg: 0.0,
            fov_deg: 60.0,
        }
    }

    /// A wall between +Z and −Z, and these cameras.
    fn world(cameras: &[Camera]) -> (World, Voxels) {
        let text = "(title: \"A wall.\", size: (64, 32, 64), origin: (-32, -16, -32),
            shape: Box(half: (32, 16, 2)))";
        let world = crate::world::file::parse(text, "test", None, &Default::default());
        let mut world = world.expect("a sound world");
        world.cameras = cameras.to_vec();
        let voxels = crate::world::generate::generate(&world);
        (world, voxels)
    }

    #[test]
    fn it_takes_the_first_way_that_there_is() {
        let here = camera("here", Vec3::new(0.0, 0.0, 25.0));
        let side = camera("side", Vec3::new(20.0, 0.0, 25.0));
        let beyond = camera("beyond", Vec3::new(0.0, 0.0, -25.0));
        let close = camera("close", Vec3::new(0.0, 0.0, 3.5));
        let course = |cameras: &[Camera], at: &Camera| {
            let (world, voxels) = world(cameras);
            Course::new(&world, &voxels, at)
        };
        let both = course(&[here.clone(), side.clone()], &close);
        assert!(matches!(both, Course::Cameras(_)), "{both:?}");
        let blocked = course(&[here.clone(), beyond], &side);
        assert!(matches!(blocked, Course::Ahead(_)), "{blocked:?}");
        let alone = course(std::slice::from_ref(&here), &here);
        assert!(matches!(alone, Course::Ahead(_)), "{alone:?}");
        let walled = course(&[here], &close);
        assert!(matches!(walled, Course::Turn(_)), "{walled:?}");
    }

    #[test]
    fn it_comes_back_and_is_the_same_every_time() {
        let here = camera("here", Vec3::new(0.0, 0.0, 25.0));
        let (world, voxels) = world(std::slice::from_ref(&here));
        let course = Course::new(&world, &voxels, &here);
        let again = Course::new(&world, &voxels, &here);
        for step in 0..=40 {
            let at = f64::from(step) / 2.0;
            assert_eq!(course.at(at, 20.0, 1.0), again.at(at, 20.0, 1.0));
        }
        let z = |elapsed_s| course.at(elapsed_s, 20.0, 1.0).position.z;
        // Twenty voxels of air before the wall.
        assert!((z(10.0) - 5.0).abs() < 1e-3);
        assert!((z(20.0) - 25.0).abs() < 1e-3);
        // In a second it flies no farther than the fastest flight allows.
        let fast = course.at(0.5, 1.0, 1.0).position.z;
        assert!((fast - 15.0).abs() < 1e-3, "{fast}");
    }

    #[test]
    fn a_turn_goes_once_around() {
        let here = camera("here", Vec3::ONE);
        let course = Course::Turn(here.clone());
        assert_eq!(course.at(5.0, 20.0, 1.0).yaw_deg, 90.0);
        assert_eq!(course.at(15.0, 20.0, 1.0).yaw_deg, -90.0);
        assert_eq!(course.at(20.0, 20.0, 1.0), here);
    }
}
