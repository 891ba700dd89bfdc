//! The path of a camera that is at its place, and in full motion, at each judged moment.

use std::f64::consts::TAU;

use super::super::super::dynamics::{FLIGHT_SPEED, RATE};
use crate::{
    reference::flight_path::Path,
    world::{Camera, World, voxels::Voxels},
};

/// Between two judged moments the camera flies ahead and back, and turns to the left, to the right and back. It
/// flies at [`FLIGHT_SPEED`] where there is room, and arrives turning at full speed.
pub struct Sweep {
    camera: Camera,
    /// `None` before a wall: then the camera only turns.
    path: Option<Path>,
    /// Voxels per second.
    speed: f32,
    /// Degrees per second, at most.
    turn_deg: f32,
    /// Frames in which the camera is at its place, ascending, from 0.
    home: Vec<u32>,
}

impl Sweep {
    /// `moments`: frames of the judged moments, ascending.
    pub fn new(
        world: &World,
        voxels: &Voxels,
        camera: &Camera,
        moments: &[u32],
        turn_deg: f32,
    ) -> Self {
        let home: Vec<u32> = std::iter::once(0).chain(moments.iter().copied()).collect();
        let longest = home.windows(2).map(|pair| pair[1] - pair[0]).max();
        let speed = FLIGHT_SPEED / world.voxel_m;
        let reach = speed * seconds(longest.unwrap_or(0)) as f32 / 2.0;
        let cameras = std::slice::from_ref(camera);
        Self {
            camera: camera.clone(),
            path: Path::new(world, voxels, cameras, reach).ok(),
            speed,
            turn_deg,
            home,
        }
    }

    /// The camera in a frame of the motion. Beyond the last moment it rests.
    pub fn at(&self, frame: u32) -> Camera {
        let next = self.home.partition_point(|home| *home <= frame);
        let (Some(&from), Some(&to)) = (self.home.get(next.wrapping_sub(1)), self.home.get(next))
        else {
            return self.camera.clone();
        };
        if frame == from {
            return self.camera.clone();
        }
        let share = f64::from(frame - from) / f64::from(to - from);
        let length_s = seconds(to - from);
        let turned = f64::from(self.turn_deg) * length_s / TAU * (TAU * share).sin();
        let out_and_back = 1.0 - (1.0 - 2.0 * share).abs();
        let position = self.path.as_ref().map(|path| {
            let reach = path.length().min(self.speed * length_s as f32 / 2.0);
            path.at(reach * out_and_back as f32).position
        });
        Camera {
            position: position.unwrap_or(self.camera.position),
            yaw_deg: self.camera.yaw_deg + turned as f32,
            ..self.camera.clone()
        }
    }
}

fn seconds(frames: u32) -> f64 {
    f64::from(frames) / RATE
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::{file, generate};

    fn sweep(z: f32, moments: &[u32]) -> (Camera, Sweep) {
        let text = format!(
            "(title: \"A wall.\", size: (64, 32, 64), origin: (-32, -16, -32),
              shape: Box(half: (32, 16, 2)), cameras: [(name: \"here\", position: (0.5, 0.5, {z}))])"
        );
        let world = file::parse(&text, "test", None, &Default::default()).expect("a sound world");
        let voxels = generate::generate(&world);
        let camera = world.cameras[0].clone();
        let sweep = Sweep::new(&world, &voxels, &camera, moments, 90.0);
        (camera, sweep)
    }

    #[test]
    fn the_camera_is_at_its_place_at_each_moment_and_moves_before() {
        let (camera, sweep) = sweep(25.0, &[60, 120, 150]);
        for moment in [0, 60, 120, 150] {
            assert_eq!(sweep.at(moment), camera, "frame {moment}");
        }
        for moment in [60, 120, 150] {
            let before = sweep.at(moment - 1);
            let turned = camera.yaw_deg - before.yaw_deg;
            assert!(
                (turned - 1.5).abs() < 0.02,
                "90 degrees per second: {turned}"
            );
            let flown = camera.position.distance(before.position);
            assert!((flown - 10.0 / 60.0).abs() < 0.01, "10 m/s: {flown}");
        }
        // One second: five metres ahead, and back.
        assert!((sweep.at(30).position.z - 20.0).abs() < 1e-3);
    }

    #[test]
    fn a_camera_before_a_wall_only_turns() {
        let (camera, sweep) = sweep(3.5, &[60]);
        assert_eq!(sweep.at(30).position, camera.position);
        assert!(sweep.at(15).yaw_deg > camera.yaw_deg + 10.0);
        assert!(sweep.at(45).yaw_deg < camera.yaw_deg - 10.0);
    }
}
