//! The keys of the window.

use winit::keyboard::{self, KeyCode, ModifiersState};

use super::input::Key;

/// What each key does, for the panel.
pub const HELP: &[(&str, &str)] = &[
    (
        "click",
        "look around with the mouse; then dig (held: on and on)",
    ),
    ("right click", "place a voxel (held: on and on)"),
    ("middle click", "take the material"),
    ("Ctrl + Z", "undo the last stroke"),
    ("Ctrl + Y", "redo it"),
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
    ("Ctrl + S", "save; also every minute, and at the end"),
    ("F1", "how to play"),
    ("Tab", "the panel: figures, and every parameter"),
    ("F2", "save a screenshot"),
    ("F3", "where you are, what you aim at, frame times"),
    ("F4", "benchmark: a flight, and its frame times"),
    ("F5", "read world and shaders again; your changes stay"),
    ("F6", "path-traced reference"),
    ("F7", "draw the probes, by another colour"),
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

/// What a key does together with Ctrl.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shortcut {
    Undo,
    Redo,
    Save,
}

/// The shortcut of a key. It goes by the letter, not by its place on the keyboard: Z and Y trade places on some.
pub fn shortcut(modifiers: ModifiersState, key: &keyboard::Key) -> Option<Shortcut> {
    let keyboard::Key::Character(letter) = key else {
        return None;
    };
    if !modifiers.control_key() || modifiers.alt_key() {
        return None;
    }
    match (letter.to_lowercase().as_str(), modifiers.shift_key()) {
        ("z", false) => Some(Shortcut::Undo),
        ("y", false) | ("z", true) => Some(Shortcut::Redo),
        ("s", false) => Some(Shortcut::Save),
        _ => None,
    }
}
