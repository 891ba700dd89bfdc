//! The one owner of camera → ray mathematics: the CPU reference and the GPU passes use this basis.

use glam::{DVec2, DVec3};

use super::scenery::Camera;

/// A pinhole camera as four vectors in world space (f64; the GPU gets them rounded to f32).
///
/// The ray through normalised device coordinates (x to the right, y up, both in [−1, 1]) starts at
/// `origin` and goes along `forward + x·right + y·up`. `forward` is a unit vector; the length of
/// `right` is tan(fov/2)·aspect, that of `up` is tan(fov/2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraBasis {
    pub origin: DVec3,
    pub forward: DVec3,
    pub right: DVec3,
    pub up: DVec3,
}

impl CameraBasis {
    /// Direction (not normalised) through a point of a picture of `size` pixels. `pixel` counts
    /// from the top left corner, so that the centre of the first pixel of the top row is (½, ½).
    pub fn direction_ws(&self, pixel: DVec2, size: DVec2) -> DVec3 {
        let across = 2.0 * pixel.x / size.x - 1.0;
        let upwards = 1.0 - 2.0 * pixel.y / size.y;
        self.forward + across * self.right + upwards * self.up
    }
}

impl Camera {
    /// The basis for a picture of this aspect ratio (width / height).
    ///
    /// Yaw 0 looks along −Z and positive yaw turns left; positive pitch looks up; there is no roll.
    pub fn basis(&self, aspect: f64) -> CameraBasis {
        let (yaw_sin, yaw_cos) = f64::from(self.yaw_deg).to_radians().sin_cos();
        let (pitch_sin, pitch_cos) = f64::from(self.pitch_deg).to_radians().sin_cos();
        let forward = DVec3::new(-yaw_sin * pitch_cos, pitch_sin, -yaw_cos * pitch_cos);
        let right = DVec3::new(yaw_cos, 0.0, -yaw_sin);
        let half_height = (0.5 * f64::from(self.fov_deg).to_radians()).tan();
        CameraBasis {
            origin: self.position.as_dvec3(),
            forward,
            right: right * (half_height * aspect),
            up: right.cross(forward) * half_height,
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    fn camera(yaw_deg: f32, pitch_deg: f32) -> Camera {
        Camera {
            name: "test".into(),
            position: Vec3::new(1.0, 2.0, 3.0),
            yaw_deg,
            pitch_deg,
            fov_deg: 90.0,
        }
    }

    fn close(a: DVec3, b: DVec3) -> bool {
        a.distance(b) < 1e-12
    }

    #[test]
    fn looks_along_minus_z_and_turns_left_and_up() {
        let ahead = camera(0.0, 0.0).basis(2.0);
        assert!(close(ahead.forward, DVec3::NEG_Z));
        assert!(close(ahead.right, DVec3::X * 2.0));
        assert!(close(ahead.up, DVec3::Y));
        assert!(close(camera(90.0, 0.0).basis(1.0).forward, DVec3::NEG_X));
        assert!(close(camera(0.0, 90.0).basis(1.0).forward, DVec3::Y));
        assert!(close(camera(0.0, 90.0).basis(1.0).up, DVec3::Z));
    }

    #[test]
    fn top_row_comes_first_and_corners_span_the_field_of_view() {
        let basis = camera(0.0, 0.0).basis(2.0);
        let size = DVec2::new(4.0, 2.0);
        assert!(close(
            basis.direction_ws(DVec2::ZERO, size),
            DVec3::new(-2.0, 1.0, -1.0)
        ));
        assert!(close(
            basis.direction_ws(size, size),
            DVec3::new(2.0, -1.0, -1.0)
        ));
        assert!(close(basis.direction_ws(size / 2.0, size), DVec3::NEG_Z));
    }

    #[test]
    fn basis_is_orthogonal_for_any_turn() {
        for step in 0..36 {
            let basis = camera(step as f32 * 37.0, step as f32 * 5.0 - 90.0).basis(1.5);
            let half = (std::f64::consts::FRAC_PI_4).tan();
            assert!((basis.forward.length() - 1.0).abs() < 1e-12);
            assert!((basis.right.length() - 1.5 * half).abs() < 1e-12);
            assert!((basis.up.length() - half).abs() < 1e-12);
            assert!(basis.forward.dot(basis.right).abs() < 1e-12);
            assert!(basis.forward.dot(basis.up).abs() < 1e-12);
            assert!(basis.right.dot(basis.up).abs() < 1e-12);
        }
    }
}
