//! Whether a frame's picture waits for the light of its own rays.
//!
//! Rays of probes and faces are few and long, so alone they leave most of a GPU idle; a picture has many short ones.
//! Side by side both take less time than one after the other, but the picture then shows the bounced light of the frame
//! before. At rest there is no difference, and a lamp that glides is one frame late; direct light is always that of the
//! frame. The picture waits where a frame of delay would show: while probes are new, after sudden changes, and while the
//! camera moves, because faces that come into view have no light yet.

use crate::world::Camera;

/// What the last frame showed.
#[derive(Default)]
pub(super) struct FrameOrder {
    camera: Option<Camera>,
}

impl FrameOrder {
    /// Whether the picture of the next frame is shaded early, by the light of the frame before. `is_calm`: probes have
    /// settled, and no lamp was switched and no voxel edited lately.
    pub fn shades_early(&mut self, camera: &Camera, is_calm: bool) -> bool {
        let is_still = self.camera.as_ref() == Some(camera);
        if !is_still {
            self.camera = Some(camera.clone());
        }
        is_still && is_calm
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn a_picture_waits_for_light_where_a_delay_would_show() {
        let mut order = FrameOrder::default();
        let camera = Camera {
            name: String::new(),
            position: Vec3::ZERO,
            yaw_deg: 0.0,
            pitch_deg: 0.0,
            fov_deg: 70.0,
        };
        assert!(!order.shades_early(&camera, true), "nothing was shown yet");
        assert!(order.shades_early(&camera, true));
        assert!(!order.shades_early(&camera, false), "light changes");
        assert!(order.shades_early(&camera, true));
        let mut moved = camera.clone();
        moved.position += Vec3::X;
        assert!(!order.shades_early(&moved, true), "the camera has moved");
        assert!(order.shades_early(&moved, true));
    }
}
