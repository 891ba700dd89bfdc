//! Keys and mouse input, gathered between frames.

use std::{collections::HashMap, time::Instant};

use glam::Vec3;
use winit::keyboard::KeyCode;

use super::camera::FlyInput;

/// What each key does, for the panel.
pub const HELP: &[(&str, &str)] = &[
    ("click", "look around with the mouse; then dig"),
    ("right click", "place a voxel"),
    ("middle click", "take the material"),
    ("Esc", "free the mouse"),
    ("W A S D", "fly"),
    ("Space / Shift", "up / down"),
    ("Ctrl", "faster"),
    ("scroll", "speed"),
    ("1 … 9", "jump to a camera"),
    ("P", "pause time"),
    ("F1", "this panel"),
    ("F2", "save a screenshot"),
    ("F3", "draw the probes, by another colour"),
    ("F4", "benchmark: a flight, and its frame times"),
    ("F5", "read world and shaders again"),
    ("F6", "path-traced reference"),
    ("F11", "full screen"),
];

/// Longest flight in one frame (seconds), so that a stall does not throw the camera out of the world.
const LONGEST_STEP_S: f32 = 0.5;

/// Input since the last frame. Keys count for as long as they were down, even if they went down and up again
/// within one slow frame.
#[derive(Default)]
pub struct Controls {
    /// For each key that is down, the time from which it counts.
    down: HashMap<KeyCode, Instant>,
    /// Seconds that keys were down since the last frame, except for those still down.
    counted_s: HashMap<KeyCode, f32>,
    look_px: [f32; 2],
}

impl Controls {
    pub fn press(&mut self, key: KeyCode, now: Instant) {
        self.down.entry(key).or_insert(now);
    }

    pub fn release(&mut self, key: KeyCode, now: Instant) {
        if let Some(since) = self.down.remove(&key) {
            *self.counted_s.entry(key).or_default() += seconds(since, now);
        }
    }

    /// Releases every key, for when the window loses the keyboard: no release will be reported.
    pub fn release_all(&mut self) {
        self.down.clear();
        self.counted_s.clear();
    }

    /// The mouse was moved by this many pixels, right and down.
    pub fn look(&mut self, right: f64, down: f64) {
        self.look_px[0] += right as f32;
        self.look_px[1] += down as f32;
    }

    /// The input since the last call.
    pub fn take(&mut self, now: Instant) -> FlyInput {
        let mut held_s = std::mem::take(&mut self.counted_s);
        for (key, since) in &mut self.down {
            *held_s.entry(*key).or_default() += seconds(*since, now);
            *since = now;
        }
        let held = |keys: &[KeyCode]| {
            let longest = keys.iter().filter_map(|key| held_s.get(key));
            longest.fold(0.0, |a: f32, b| a.max(*b)).min(LONGEST_STEP_S)
        };
        let axis = |plus: &[KeyCode], minus: &[KeyCode]| held(plus) - held(minus);
        let [look_right_px, look_down_px] = std::mem::take(&mut self.look_px);
        FlyInput {
            held_s: Vec3::new(
                axis(&[KeyCode::KeyD], &[KeyCode::KeyA]),
                axis(
                    &[KeyCode::Space],
                    &[KeyCode::ShiftLeft, KeyCode::ShiftRight],
                ),
                axis(&[KeyCode::KeyW], &[KeyCode::KeyS]),
            ),
            boost: held(&[KeyCode::ControlLeft, KeyCode::ControlRight]) > 0.0,
            look_right_px,
            look_down_px,
        }
    }
}

fn seconds(since: Instant, now: Instant) -> f32 {
    now.saturating_duration_since(since).as_secs_f32()
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn keys_count_for_as_long_as_they_are_down() {
        let start = Instant::now();
        let after = |ms| start + Duration::from_millis(ms);
        let mut controls = Controls::default();
        controls.press(KeyCode::KeyW, after(0));
        // Auto-repeat is not a second press.
        controls.press(KeyCode::KeyW, after(50));
        // A tap within a slow frame.
        controls.press(KeyCode::KeyA, after(60));
        controls.release(KeyCode::KeyA, after(90));
        let first = controls.take(after(100)).held_s;
        assert!((first - Vec3::new(-0.03, 0.0, 0.1)).length() < 1e-6);
        controls.release(KeyCode::KeyW, after(120));
        let second = controls.take(after(200)).held_s;
        assert!((second - Vec3::new(0.0, 0.0, 0.02)).length() < 1e-6);
        assert_eq!(controls.take(after(300)), FlyInput::default());
    }

    #[test]
    fn opposite_keys_cancel_stalls_are_cut_and_lost_focus_stops() {
        let start = Instant::now();
        let later = start + Duration::from_secs(9);
        let mut controls = Controls::default();
        for key in [KeyCode::Space, KeyCode::ShiftLeft, KeyCode::KeyD] {
            controls.press(key, start);
        }
        assert_eq!(
            controls.take(later).held_s,
            Vec3::new(LONGEST_STEP_S, 0.0, 0.0)
        );
        controls.release_all();
        assert_eq!(
            controls.take(later + Duration::from_secs(1)),
            FlyInput::default()
        );
    }

    #[test]
    fn mouse_moves_add_up_once() {
        let now = Instant::now();
        let mut controls = Controls::default();
        controls.look(3.0, -1.0);
        controls.look(2.0, 0.5);
        let input = controls.take(now);
        assert_eq!((input.look_right_px, input.look_down_px), (5.0, -0.5));
        assert_eq!(controls.take(now).look_right_px, 0.0);
    }
}
