//! Which passes a frame needs, and in what order: whether its picture waits for the light of its own rays, and whether
//! faces are asked which lamps they see.
//!
//! Rays of probes and faces are few and long, so alone they leave most of a GPU idle; a picture has many short ones.
//! Side by side both take less time than one after the other, but the picture then shows the bounced light of the frame
//! before. At rest there is no difference, and a lamp that glides is one frame late; direct light is always that of the
//! frame. The picture waits where a frame of delay would show: while probes are new, after sudden changes, and while the
//! camera moves, because faces that come into view have no light yet.

use crate::world::Camera;

/// Once camera, lamps and voxels have been still for this many frames, all visible faces know which lamps they see: each
/// pixel has had many turns to list its face.
const ASKED_FRAMES: u32 = 64;
/// While bodies move, faces come into view beside them: they are asked in one of so many frames.
const BESIDE_BODIES: u32 = 4;
/// A camera that moves so far in a frame (voxels) jumps: it flies by fewer.
const JUMP: f32 = 8.0;
/// For so many frames after a jump probes and faces find the light of what is new in the picture.
const NEW_PICTURE: u32 = 64;

/// What the last frames showed.
#[derive(Default)]
pub(super) struct FrameOrder {
    camera: Option<Camera>,
    /// Whether the camera stood where it was.
    is_still: bool,
    /// The last frame in which anything changed that says which lamps faces see.
    changed: u32,
    /// The last frame in which the camera had jumped.
    jumped: u32,
}

impl FrameOrder {
    /// Begins a frame. Its number may start from 0 again.
    pub fn begin_frame(&mut self, camera: &Camera, frame: u32) {
        let last = self.camera.as_ref();
        self.is_still = last == Some(camera);
        let jumps = last.is_some_and(|last| last.position.distance(camera.position) > JUMP);
        if jumps || frame < self.jumped {
            self.jumped = frame;
        }
        if !self.is_still {
            self.camera = Some(camera.clone());
        }
        if !self.is_still || frame < self.changed {
            self.changed = frame;
        }
    }

    /// Whether all that the camera sees is new, because it has jumped lately.
    pub fn is_cut(&self, frame: u32) -> bool {
        frame - self.jumped < NEW_PICTURE
    }

    /// Whether the picture is shaded early, by the light of the frame before. `is_calm`: probes have settled, and no lamp
    /// was switched and no voxel edited lately.
    pub fn shades_early(&self, is_calm: bool) -> bool {
        self.is_still && is_calm
    }

    /// Whether to ask faces which lamps they see, because some may not know. `changes`: a lamp has moved, is new or is listed
    /// anew, or a voxel was edited. `bodies_move`: bodies may uncover faces.
    pub fn asks_faces(&mut self, frame: u32, changes: bool, bodies_move: bool) -> bool {
        if changes {
            self.changed = frame;
        }
        let may_be_new = bodies_move && frame.is_multiple_of(BESIDE_BODIES);
        may_be_new || frame - self.changed < ASKED_FRAMES
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    fn camera() -> Camera {
        Camera {
            name: String::new(),
            position: Vec3::ZERO,
            yaw_deg: 0.0,
            pitch_deg: 0.0,
            fov_deg: 70.0,
        }
    }

    #[test]
    fn a_picture_waits_for_light_where_a_delay_would_show() {
        let mut order = FrameOrder::default();
        let mut shades_early = |camera: &Camera, is_calm| {
            order.begin_frame(camera, 0);
            order.shades_early(is_calm)
        };
        let camera = camera();
        assert!(!shades_early(&camera, true), "nothing was shown yet");
        assert!(shades_early(&camera, true));
        assert!(!shades_early(&camera, false), "light changes");
        assert!(shades_early(&camera, true));
        let mut moved = camera.clone();
        moved.position += Vec3::X;
        assert!(!shades_early(&moved, true), "the camera has moved");
        assert!(shades_early(&moved, true));
    }

    #[test]
    fn faces_are_asked_until_nothing_has_changed_for_long() {
        let mut order = FrameOrder::default();
        let mut asks = |camera: &Camera, frame, changes| {
            order.begin_frame(camera, frame);
            order.asks_faces(frame, changes, false)
        };
        let still = camera();
        for frame in 0..ASKED_FRAMES {
            assert!(asks(&still, frame, false), "frame {frame}");
        }
        assert!(!asks(&still, ASKED_FRAMES, false));
        assert!(asks(&still, 100, true), "a lamp moves");
        assert!(asks(&still, 99 + ASKED_FRAMES, false));
        assert!(!asks(&still, 100 + ASKED_FRAMES, false));
        let mut moved = camera();
        moved.yaw_deg = 1.0;
        assert!(asks(&moved, 200, false), "the camera turns");
        assert!(!asks(&moved, 300, false));
        assert!(asks(&moved, 0, false), "the probes start again");
    }

    #[test]
    fn a_picture_is_new_for_a_while_after_a_jump_but_not_in_flight() {
        let mut order = FrameOrder::default();
        let mut camera = camera();
        let mut is_cut = |way: f32, frame| {
            camera.position += way * Vec3::X;
            order.begin_frame(&camera, frame);
            order.is_cut(frame)
        };
        assert!(is_cut(0.0, 0), "the first picture");
        assert!(!is_cut(JUMP, NEW_PICTURE), "in flight");
        assert!(is_cut(JUMP + 1.0, 200), "a jump");
        assert!(is_cut(1.0, 199 + NEW_PICTURE));
        assert!(!is_cut(1.0, 200 + NEW_PICTURE));
        assert!(is_cut(0.0, 0), "the probes start again");
    }

    #[test]
    fn faces_that_bodies_uncover_are_asked_in_turn() {
        let mut order = FrameOrder::default();
        order.begin_frame(&camera(), 0);
        let asked = |order: &mut FrameOrder, bodies_move| {
            let later = ASKED_FRAMES..ASKED_FRAMES + 40;
            later
                .filter(|&frame| order.asks_faces(frame, false, bodies_move))
                .count()
        };
        assert_eq!(asked(&mut order, false), 0);
        assert_eq!(asked(&mut order, true), 10);
    }
}
