//! The free-flying camera: a function of the input and its duration.

use glam::Vec3;

use crate::world::Camera;

/// What a user did since the last frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FlyInput {
    /// Seconds of flight to the right (x), up (y) and forwards (z): how long the keys were held.
    pub held_s: Vec3,
    /// Whether the flight was [`BOOST`] times as fast.
    pub boost: bool,
    /// How far the mouse was moved, in pixels to the right.
    pub look_right_px: f32,
    /// In pixels downwards.
    pub look_down_px: f32,
}

/// How much faster a boosted flight is.
pub const BOOST: f32 = 4.0;
/// Speeds that can be chosen (voxels a second).
pub const SPEEDS: std::ops::RangeInclusive<f32> = 0.5..=500.0;
/// A speed to look around a cave with (voxels a second).
pub const DEFAULT_SPEED: f32 = 12.0;

const DEGREES_PER_PIXEL: f32 = 0.1;
/// One degree short of straight up and down, where left and right would trade places.
const STEEPEST_DEG: f32 = 89.0;
const SPEED_PER_NOTCH: f32 = 1.2;

/// The camera after this input. Forwards is where it looks; up is always the world's. `speed` is in voxels a
/// second. The same time held gives the same place, whatever the frame rate.
pub fn flown(camera: &Camera, input: &FlyInput, speed: f32) -> Camera {
    let mut next = camera.clone();
    next.yaw_deg =
        (next.yaw_deg - input.look_right_px * DEGREES_PER_PIXEL + 180.0).rem_euclid(360.0) - 180.0;
    next.pitch_deg = (next.pitch_deg - input.look_down_px * DEGREES_PER_PIXEL)
        .clamp(-STEEPEST_DEG, STEEPEST_DEG);
    let basis = next.basis(1.0);
    let right = basis.right.normalize().as_vec3();
    let forward = basis.forward.as_vec3();
    let course = right * input.held_s.x + Vec3::Y * input.held_s.y + forward * input.held_s.z;
    // Two keys at once fly no faster than one.
    let longest_s = input.held_s.abs().max_element();
    let boost = if input.boost { BOOST } else { 1.0 };
    next.position += course.normalize_or_zero() * (longest_s * speed * boost);
    next
}

/// The speed after this many notches of the mouse wheel (away from the user is faster).
pub fn scrolled(speed: f32, notches: f32) -> f32 {
    (speed * SPEED_PER_NOTCH.powf(notches)).clamp(*SPEEDS.start(), *SPEEDS.end())
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn camera(yaw_deg: f32, pitch_deg: f32) -> Camera {
        Camera {
            name: "test".into(),
            position: Vec3::new(1.0, 2.0, 3.0),
            yaw_deg,
            pitch_deg,
            fov_deg: 70.0,
        }
    }

    fn held(x: f32, y: f32, z: f32) -> FlyInput {
        FlyInput {
            held_s: Vec3::new(x, y, z),
            ..Default::default()
        }
    }

    fn flight(yaw_deg: f32, pitch_deg: f32, input: &FlyInput) -> Vec3 {
        let from = camera(yaw_deg, pitch_deg);
        flown(&from, input, 10.0).position - from.position
    }

    #[test]
    fn keys_fly_where_they_say() {
        let close = |a: Vec3, b: Vec3| assert!(a.distance(b) < 1e-4, "{a} is not {b}");
        close(flight(0.0, 0.0, &held(0.0, 0.0, 1.0)), Vec3::NEG_Z * 10.0);
        close(flight(0.0, 0.0, &held(1.0, 0.0, 0.0)), Vec3::X * 10.0);
        close(flight(90.0, 0.0, &held(0.0, 0.0, 1.0)), Vec3::NEG_X * 10.0);
        close(flight(90.0, 0.0, &held(1.0, 0.0, 0.0)), Vec3::NEG_Z * 10.0);
        // Up is the world's, whatever the pitch of the camera; forwards is where it looks.
        close(flight(30.0, -60.0, &held(0.0, 0.5, 0.0)), Vec3::Y * 5.0);
        assert!(flight(30.0, -60.0, &held(0.0, 0.0, 1.0)).y < -8.0);
        assert_eq!(flight(30.0, -60.0, &held(0.0, 0.0, 0.0)), Vec3::ZERO);
    }

    #[test]
    fn two_keys_are_no_faster_than_one_and_boost_is() {
        assert!((flight(20.0, 0.0, &held(1.0, 0.0, 1.0)).length() - 10.0).abs() < 1e-4);
        let boosted = FlyInput {
            boost: true,
            ..held(1.0, 0.0, 0.0)
        };
        assert!((flight(20.0, 0.0, &boosted).length() - 10.0 * BOOST).abs() < 1e-4);
    }

    #[test]
    fn looking_turns_right_and_down_and_stops_at_the_poles() {
        let look = |right, down| {
            let input = FlyInput {
                look_right_px: right,
                look_down_px: down,
                ..Default::default()
            };
            flown(&camera(170.0, 10.0), &input, 1.0)
        };
        assert!((look(100.0, 0.0).yaw_deg - 160.0).abs() < 1e-3);
        assert!((look(-200.0, 0.0).yaw_deg + 170.0).abs() < 1e-3, "wraps");
        assert!((look(0.0, 50.0).pitch_deg - 5.0).abs() < 1e-3);
        assert_eq!(look(0.0, 1e6).pitch_deg, -STEEPEST_DEG);
        assert_eq!(look(0.0, -1e6).pitch_deg, STEEPEST_DEG);
    }

    #[test]
    fn speeds_stay_in_range_and_notches_undo_each_other() {
        assert!((scrolled(scrolled(12.0, 3.0), -3.0) - 12.0).abs() < 1e-4);
        assert_eq!(scrolled(12.0, 1000.0), *SPEEDS.end());
        assert_eq!(scrolled(12.0, -1000.0), *SPEEDS.start());
    }

    proptest! {
        /// However a second is cut into frames, the camera ends at the same place.
        #[test]
        fn flight_is_independent_of_the_frame_rate(
            frames in 1u32..200,
            yaw in -180.0f32..180.0,
            pitch in -89.0f32..89.0,
            keys in prop::array::uniform3(-1i8..=1),
        ) {
            let direction = Vec3::from(keys.map(f32::from));
            let once = flown(&camera(yaw, pitch), &FlyInput { held_s: direction, ..Default::default() }, 10.0);
            let mut many = camera(yaw, pitch);
            for _ in 0..frames {
                let input = FlyInput { held_s: direction / frames as f32, ..Default::default() };
                many = flown(&many, &input, 10.0);
            }
            prop_assert!(many.position.distance(once.position) < 1e-2);
            prop_assert!((many.yaw_deg - once.yaw_deg).abs() < 1e-2);
        }

        /// Whatever the mouse does, the picture has no roll and is never upside down.
        #[test]
        fn the_camera_never_rolls(right in -1e5f32..1e5, down in -1e5f32..1e5) {
            let input = FlyInput { look_right_px: right, look_down_px: down, ..Default::default() };
            let basis = flown(&camera(0.0, 0.0), &input, 1.0).basis(1.0);
            prop_assert!(basis.right.y.abs() < 1e-12);
            prop_assert!(basis.up.y > 0.0);
        }
    }
}
