//! The path of a camera flight.

use glam::Vec3;

use super::march::{Outcome, Ray, march};
use crate::world::{Camera, World, voxels::Voxels};

/// Why there is no path to fly, in words for the user.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct NoWay(String);

/// A line through cameras, flown back and forth.
#[derive(Debug)]
pub struct Path {
    /// At least two.
    cameras: Vec<Camera>,
    /// Distance from the first camera to each camera, in voxels.
    along: Vec<f32>,
}

/// Distance in voxels that a flight keeps from the wall ahead.
const CLEARANCE: f32 = 3.0;

impl Path {
    /// Through all cameras. From a single camera: straight ahead as far as there is air, at most
    /// `length` voxels.
    ///
    /// # Errors
    /// If solid voxels are in the way.
    pub fn new(
        world: &World,
        voxels: &Voxels,
        cameras: &[Camera],
        length: f32,
    ) -> Result<Self, NoWay> {
        let mut cameras = cameras.to_vec();
        if let [camera] = &cameras[..] {
            let forward = camera.basis(1.0).forward.as_vec3();
            let free = free(world, voxels, camera.position, forward).min(length);
            let mut end = camera.clone();
            end.position += forward * free;
            cameras.push(end);
        }
        let mut along = vec![0.0];
        for pair in cameras.windows(2) {
            let way = pair[1].position - pair[0].position;
            let [from, to] = [&pair[0].name, &pair[1].name];
            if way.length() < 1.0 {
                return Err(NoWay(format!(
                    "there is no way to fly from camera `{from}` of {}: it faces a wall",
                    world.name
                )));
            }
            let direction = way.normalize();
            if free(world, voxels, pair[0].position, direction) + CLEARANCE < way.length() {
                return Err(NoWay(format!(
                    "solid voxels are in the way from camera `{from}` to `{to}` of {}; name cameras that see each \
                     other",
                    world.name
                )));
            }
            along.push(along[along.len() - 1] + way.length());
        }
        Ok(Self { cameras, along })
    }

    /// Distance from the first camera to the last, in voxels.
    pub fn length(&self) -> f32 {
        self.along[self.along.len() - 1]
    }

    /// The camera after `flown` voxels.
    pub fn at(&self, flown: f32) -> Camera {
        let length = self.length();
        let turn = flown.rem_euclid(2.0 * length);
        let place = turn.min(2.0 * length - turn);
        // Without the last camera: it only ends a leg.
        let leg = self.along[1..self.along.len() - 1].partition_point(|end| *end < place);
        let [from, to] = [&self.cameras[leg], &self.cameras[leg + 1]];
        let share = (place - self.along[leg]) / (self.along[leg + 1] - self.along[leg]);
        let mix = |a: f32, b: f32| a + (b - a) * share;
        // The shorter direction of rotation.
        let yaw = (to.yaw_deg - from.yaw_deg + 180.0).rem_euclid(360.0) - 180.0;
        Camera {
            position: from.position.lerp(to.position, share),
            yaw_deg: from.yaw_deg + yaw * share,
            pitch_deg: mix(from.pitch_deg, to.pitch_deg),
            fov_deg: mix(from.fov_deg, to.fov_deg),
            ..from.clone()
        }
    }
}

/// Voxels of air along a unit vector, minus the clearance.
fn free(world: &World, voxels: &Voxels, from: Vec3, direction: Vec3) -> f32 {
    let origin = from.as_dvec3() - world.origin.as_dvec3();
    match march(voxels, &Ray::new(origin, direction.as_dvec3())) {
        Outcome::Hit(hit) => (hit.distance as f32 - CLEARANCE).max(0.0),
        Outcome::Inside(_) => 0.0,
        Outcome::Miss => f32::INFINITY,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera(name: &str, position: Vec3, yaw_deg: f32) -> Camera {
        Camera {
            name: name.into(),
            position,
            yaw_deg,
            pitch_deg: 0.0,
            fov_deg: 60.0,
        }
    }

    fn world() -> (World, Voxels) {
        let text = "(title: \"A wall.\", size: (64, 32, 64), origin: (-32, -16, -32),
            shape: Box(half: (32, 16, 2)))";
        let world = crate::world::file::parse(text, "test", None, &Default::default());
        let world = world.expect("a sound world");
        let voxels = crate::world::generate::generate(&world);
        (world, voxels)
    }

    #[test]
    fn a_flight_goes_back_and_forth_before_the_wall() {
        let (world, voxels) = world();
        let start = camera("start", Vec3::new(0.0, 0.0, 25.0), 0.0);
        let path = Path::new(&world, &voxels, &[start], 200.0).expect("20 voxels of air");
        let z = |flown: f32| path.at(flown).position.z;
        assert_eq!([z(0.0), z(10.0), z(20.0)], [25.0, 15.0, 5.0]);
        assert_eq!([z(30.0), z(40.0), z(50.0)], [15.0, 25.0, 15.0]);
    }

    #[test]
    fn legs_join_cameras_and_take_the_shorter_rotation() {
        let (world, voxels) = world();
        let cameras = [
            camera("a", Vec3::new(0.0, 0.0, 20.0), 170.0),
            camera("b", Vec3::new(10.0, 0.0, 20.0), -170.0),
            camera("c", Vec3::new(10.0, 5.0, 20.0), -170.0),
        ];
        let path = Path::new(&world, &voxels, &cameras, 1.0).expect("nothing is in the way");
        assert_eq!(path.at(5.0).position, Vec3::new(5.0, 0.0, 20.0));
        assert_eq!(path.at(5.0).yaw_deg, 180.0);
        assert_eq!(path.at(12.5).position, Vec3::new(10.0, 2.5, 20.0));
        assert_eq!(path.at(25.0).position, Vec3::new(5.0, 0.0, 20.0));
    }

    #[test]
    fn solid_voxels_in_the_way_are_an_error() {
        let (world, voxels) = world();
        let near = camera("near", Vec3::new(0.0, 0.0, 25.0), 0.0);
        let beyond = camera("beyond", Vec3::new(0.0, 0.0, -25.0), 0.0);
        let refused = |cameras: &[Camera]| {
            let error = Path::new(&world, &voxels, cameras, 50.0).expect_err("stone");
            error.to_string()
        };
        assert!(refused(&[near.clone(), beyond]).contains("from camera `near` to `beyond`"));
        let mut close = near;
        close.position.z = 3.5;
        assert!(refused(&[close]).contains("faces a wall"));
    }
}
