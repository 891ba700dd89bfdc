//! The keys of the window.

use winit::keyboard::KeyCode;

use super::input::Key;

/// What each key does, for the panel.
pub const HELP: &[(&str, &str)] = &[
    ("click", "look around with the mouse; then dig"),
    ("right click", "place a voxel"),
    ("middle click", "take the material"),
    ("Esc", "the menu, and a pause"),
    ("W A S D", "walk, or fly"),
    ("Space", "jump; rise in flight"),
    ("Shift", "sneak: never over an edge; sink in flight"),
    ("Ctrl, W W", "run; fly fast"),
    ("K, Space Space", "fly, or walk again"),
    ("H", "pass through voxels, or not"),
    ("scroll", "speed of flight"),
    ("1 … 9", "jump to a camera"),
    ("P", "pause time"),
    ("F1", "how to play"),
    ("Tab", "the panel: figures, and every parameter"),
    ("F2", "save a screenshot"),
    ("F3", "draw the probes, by another colour"),
    ("F4", "benchmark: a flight, and its frame times"),
    ("F5", "read world and shaders again"),
    ("F6", "path-traced reference"),
    ("F11", "full screen"),
];

/// The key of the player that a key of the keyboard is.
pub fn player_key(code: KeyCode) -> Option<Key> {
    Some(match code {
        KeyCode::KeyW => Key::Forward,
        KeyCode::KeyS => Key::Back,
        KeyCode::KeyA => Key::Left,
        KeyCode::KeyD => Key::Right,
        KeyCode::Space => Key::Up,
        KeyCode::ShiftLeft | KeyCode::ShiftRight => Key::Down,
        KeyCode::ControlLeft | KeyCode::ControlRight => Key::Run,
        KeyCode::KeyK => Key::Fly,
        KeyCode::KeyH => Key::NoClip,
        _ => return None,
    })
}
