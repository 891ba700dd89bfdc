//! What a user can do with a key, and which keys do it.
//!
//! `ACTIONS` is the one table of actions: the help, the page of keys, the input of the window, the settings file and
//! `docs/notes/controls.md` follow it. `bindings` holds the user's keys, and `trigger` names keys and buttons.

mod bindings;
mod trigger;

use winit::{event::MouseButton, keyboard::KeyCode};

pub use bindings::{Bindings, SLOTS};
pub use trigger::{Chord, Modifiers, Press, Trigger};

use super::input::Key;

/// Something that a key or a button does. The order is that of the pages.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Action {
    Forward,
    Left,
    Back,
    Right,
    Up,
    Down,
    Run,
    Fly,
    NoClip,
    Dig,
    Place,
    Pick,
    /// Gives voxels the material in the hand.
    Replace,
    BrushShape,
    SmallerBrush,
    LargerBrush,
    /// Marks a corner of a box; the second one copies the box.
    Mark,
    Paste,
    /// Turns the copy.
    Turn,
    /// Pastes the copy's air too, or not.
    Air,
    /// Makes a body of voxels.
    Lift,
    /// Makes voxels of a body.
    Settle,
    Undo,
    Redo,
    /// What is in the hand, by the index of its slot.
    Slot(u8),
    Inventory,
    FlyFaster,
    FlySlower,
    /// Jump to a camera of the world, by its index.
    Camera(u8),
    PauseTime,
    Mute,
    Save,
    Help,
    Panel,
    Screenshot,
    Readout,
    Benchmark,
    Reload,
    Reference,
    Probes,
    FullScreen,
}

/// A row of the table of actions.
pub struct Entry {
    pub action: Action,
    /// Its name in the settings file. It never changes.
    pub id: &'static str,
    /// Its name on the page of keys.
    pub name: &'static str,
    /// What it does, in the help. Neighbours with the same line share a row there.
    pub help: &'static str,
    /// Its keys, unless the user chose others.
    pub defaults: &'static [Chord],
}

const fn entry(
    action: Action,
    id: &'static str,
    name: &'static str,
    help: &'static str,
    defaults: &'static [Chord],
) -> Entry {
    Entry {
        action,
        id,
        name,
        help,
        defaults,
    }
}

const WALK: &str = "walk, or fly";
const SLOT: &str = "what is in the hand";
const SPEED: &str = "speed of flight";
const BRUSH: &str = "the brush: one voxel, a ball, a box; its size";
const BODY: &str = "lift voxels out as a body to push, set it in again";
const COPY: &str = "paste the copy, turn it, with its air or without";
const CAMERAS: &str = "jump to a camera of the world";

/// Every action.
#[rustfmt::skip]
pub const ACTIONS: &[Entry] = &[
    entry(Action::Forward, "forward", "forward", WALK, &[key(KeyCode::KeyW)]),
    entry(Action::Left, "left", "left", WALK, &[key(KeyCode::KeyA)]),
    entry(Action::Back, "back", "back", WALK, &[key(KeyCode::KeyS)]),
    entry(Action::Right, "right", "right", WALK, &[key(KeyCode::KeyD)]),
    entry(Action::Up, "up", "jump, rise", "jump; rise in flight", &[key(KeyCode::Space)]),
    entry(Action::Down, "down", "sneak, sink", "sneak: never over an edge; sink in flight", &[key(KeyCode::ShiftLeft)]),
    entry(Action::Run, "run", "run", "run, fly fast (or press forward twice)", &[key(KeyCode::ControlLeft)]),
    entry(Action::Fly, "fly", "fly, walk", "fly, or walk again (or jump twice)", &[key(KeyCode::KeyK)]),
    entry(Action::NoClip, "no_clip", "pass through voxels", "pass through voxels, or not", &[key(KeyCode::KeyH)]),
    entry(Action::Dig, "dig", "dig", "dig (held: on and on)", &[button(MouseButton::Left)]),
    entry(Action::Place, "place", "place", "place what is in the hand; switch a lamp", &[button(MouseButton::Right)]),
    entry(Action::Pick, "pick", "take into the hand", "take what you look at into the hand", &[button(MouseButton::Middle)]),
    entry(Action::Replace, "replace", "replace", "give voxels the material in the hand (held: on and on)", &[key(KeyCode::KeyG)]),
    entry(Action::BrushShape, "brush_shape", "brush", BRUSH, &[key(KeyCode::KeyB)]),
    entry(Action::SmallerBrush, "smaller_brush", "smaller brush", BRUSH, &[key(KeyCode::BracketLeft)]),
    entry(Action::LargerBrush, "larger_brush", "larger brush", BRUSH, &[key(KeyCode::BracketRight)]),
    entry(Action::Mark, "mark", "mark a corner", "mark two corners: copies the box; Esc puts it away", &[key(KeyCode::KeyC)]),
    entry(Action::Paste, "paste", "paste", COPY, &[key(KeyCode::KeyV)]),
    entry(Action::Turn, "turn", "turn the copy", COPY, &[key(KeyCode::KeyR)]),
    entry(Action::Air, "air", "paste air too", COPY, &[key(KeyCode::KeyN)]),
    entry(Action::Lift, "lift", "lift out a body", BODY, &[key(KeyCode::KeyL)]),
    entry(Action::Settle, "settle", "set a body", BODY, &[key(KeyCode::KeyJ)]),
    entry(Action::Undo, "undo", "undo", "undo the last stroke", &[ctrl(KeyCode::KeyZ)]),
    entry(Action::Redo, "redo", "redo", "redo it", &[ctrl(KeyCode::KeyY), ctrl_shift(KeyCode::KeyZ)]),
    entry(Action::Slot(0), "slot_1", "slot 1", SLOT, &[key(KeyCode::Digit1)]),
    entry(Action::Slot(1), "slot_2", "slot 2", SLOT, &[key(KeyCode::Digit2)]),
    entry(Action::Slot(2), "slot_3", "slot 3", SLOT, &[key(KeyCode::Digit3)]),
    entry(Action::Slot(3), "slot_4", "slot 4", SLOT, &[key(KeyCode::Digit4)]),
    entry(Action::Slot(4), "slot_5", "slot 5", SLOT, &[key(KeyCode::Digit5)]),
    entry(Action::Slot(5), "slot_6", "slot 6", SLOT, &[key(KeyCode::Digit6)]),
    entry(Action::Slot(6), "slot_7", "slot 7", SLOT, &[key(KeyCode::Digit7)]),
    entry(Action::Slot(7), "slot_8", "slot 8", SLOT, &[key(KeyCode::Digit8)]),
    entry(Action::Slot(8), "slot_9", "slot 9", SLOT, &[key(KeyCode::Digit9)]),
    entry(Action::Slot(9), "slot_10", "slot 10", SLOT, &[key(KeyCode::Digit0)]),
    entry(Action::Inventory, "inventory", "inventory", "the inventory: all materials and lamps", &[key(KeyCode::KeyE)]),
    entry(Action::FlyFaster, "fly_faster", "fly faster", SPEED, &[key(KeyCode::PageUp)]),
    entry(Action::FlySlower, "fly_slower", "fly slower", SPEED, &[key(KeyCode::PageDown)]),
    entry(Action::Camera(0), "camera_1", "camera 1", CAMERAS, &[alt(KeyCode::Digit1)]),
    entry(Action::Camera(1), "camera_2", "camera 2", CAMERAS, &[alt(KeyCode::Digit2)]),
    entry(Action::Camera(2), "camera_3", "camera 3", CAMERAS, &[alt(KeyCode::Digit3)]),
    entry(Action::Camera(3), "camera_4", "camera 4", CAMERAS, &[alt(KeyCode::Digit4)]),
    entry(Action::Camera(4), "camera_5", "camera 5", CAMERAS, &[alt(KeyCode::Digit5)]),
    entry(Action::Camera(5), "camera_6", "camera 6", CAMERAS, &[alt(KeyCode::Digit6)]),
    entry(Action::Camera(6), "camera_7", "camera 7", CAMERAS, &[alt(KeyCode::Digit7)]),
    entry(Action::Camera(7), "camera_8", "camera 8", CAMERAS, &[alt(KeyCode::Digit8)]),
    entry(Action::Camera(8), "camera_9", "camera 9", CAMERAS, &[alt(KeyCode::Digit9)]),
    entry(Action::PauseTime, "pause_time", "pause time", "pause time, or let it run", &[key(KeyCode::KeyP)]),
    entry(Action::Mute, "mute", "mute", "mute sound, or hear it", &[key(KeyCode::KeyM)]),
    entry(Action::Save, "save", "save", "save; also every minute, and at the end", &[ctrl(KeyCode::KeyS)]),
    entry(Action::Help, "help", "help", "how to play, and a pause", &[key(KeyCode::F1)]),
    entry(Action::Panel, "panel", "panel", "the panel: figures, and every parameter", &[key(KeyCode::Tab)]),
    entry(Action::Screenshot, "screenshot", "screenshot", "save a screenshot", &[key(KeyCode::F2), key(KeyCode::F12)]),
    entry(Action::Readout, "readout", "readout", "where you are, what you aim at, frame times", &[key(KeyCode::F3)]),
    entry(Action::Benchmark, "benchmark", "benchmark", "benchmark: a flight, and its frame times", &[key(KeyCode::F4)]),
    entry(Action::Reload, "reload", "read again", "read world and shaders again; your changes stay", &[key(KeyCode::F5)]),
    entry(Action::Reference, "reference", "reference", "path-traced reference, or light by probes", &[key(KeyCode::F6)]),
    entry(Action::Probes, "probes", "draw the probes", "draw the probes, by another colour", &[key(KeyCode::F7)]),
    entry(Action::FullScreen, "full_screen", "full screen", "full screen, or a window", &[key(KeyCode::F11)]),
];

/// What has no key to choose: input, and what it does.
pub const FIXED: &[(&str, &str)] = &[
    ("Mouse", "look around, after a click into the picture"),
    ("Wheel", "what is in the hand"),
    ("Esc", "the menu, and a pause"),
];

const fn key(code: KeyCode) -> Chord {
    Chord::plain(Trigger::Key(code))
}

const fn button(button: MouseButton) -> Chord {
    Chord::plain(Trigger::Mouse(button))
}

const fn alt(code: KeyCode) -> Chord {
    Chord {
        modifiers: Modifiers {
            alt: true,
            ..Modifiers::NONE
        },
        trigger: Trigger::Key(code),
    }
}

const fn ctrl(code: KeyCode) -> Chord {
    Chord {
        modifiers: Modifiers {
            ctrl: true,
            ..Modifiers::NONE
        },
        trigger: Trigger::Key(code),
    }
}

const fn ctrl_shift(code: KeyCode) -> Chord {
    Chord {
        modifiers: Modifiers {
            ctrl: true,
            shift: true,
            ..Modifiers::NONE
        },
        trigger: Trigger::Key(code),
    }
}

impl Action {
    /// Its row in the table.
    pub fn entry(self) -> &'static Entry {
        ACTIONS
            .iter()
            .find(|entry| entry.action == self)
            .expect("every action has a row: a test holds it")
    }

    /// The key of the player that it is, if it is one.
    pub fn player_key(self) -> Option<Key> {
        Some(match self {
            Self::Forward => Key::Forward,
            Self::Back => Key::Back,
            Self::Left => Key::Left,
            Self::Right => Key::Right,
            Self::Up => Key::Up,
            Self::Down => Key::Down,
            Self::Run => Key::Run,
            Self::Fly => Key::Fly,
            Self::NoClip => Key::NoClip,
            _ => return None,
        })
    }

    /// Whether a key that is held does it again and again.
    pub fn repeats(self) -> bool {
        matches!(self, Self::Undo | Self::Redo)
    }
}

/// The rows of the help: keys, and what they do.
pub fn help(bindings: &Bindings) -> Vec<(String, &'static str)> {
    let fixed = FIXED.iter().map(|(keys, does)| ((*keys).to_owned(), *does));
    let rows = ACTIONS.chunk_by(|a, b| a.help == b.help);
    fixed
        .chain(rows.map(|row| (keys_of(row, bindings), row[0].help)))
        .collect()
}

/// Longest row of actions whose keys are all named.
const NAMED: usize = 4;

/// The keys of actions that share a row: all keys of one, the first of each of several.
fn keys_of(row: &[Entry], bindings: &Bindings) -> String {
    let first = |entry: &Entry| bindings.first(entry.action);
    match row {
        [entry] => bindings.names(entry.action),
        [one, .., last] if row.len() > NAMED => format!("{} … {}", first(one), first(last)),
        few => few.iter().map(first).collect::<Vec<_>>().join(" "),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn every_action_has_one_row_and_its_own_keys() {
        let mut seen = (HashSet::new(), HashSet::new(), HashSet::new());
        for entry in ACTIONS {
            assert!(seen.0.insert(entry.action), "{} twice", entry.id);
            assert!(seen.1.insert(entry.id), "{} twice", entry.id);
            assert!(entry.defaults.len() <= SLOTS, "{}", entry.id);
            for chord in entry.defaults {
                assert!(seen.2.insert(*chord), "{chord} of {} is taken", entry.id);
                assert!(chord.can_be_bound(), "{chord}");
            }
        }
    }

    #[test]
    fn the_help_joins_neighbours() {
        let rows = help(&Bindings::default());
        let of = |does: &str| {
            let row = rows.iter().find(|row| row.1 == does);
            row.map(|row| row.0.clone()).expect("a row")
        };
        assert_eq!(of(WALK), "W A S D");
        assert_eq!(of(CAMERAS), "Alt+1 … Alt+9");
        assert_eq!(of("redo it"), "Ctrl+Y, Ctrl+Shift+Z");
        assert_eq!(of("the menu, and a pause"), "Esc");
    }

    /// Set `GROTTO_UPDATE=1` to write the page.
    #[test]
    fn the_page_of_controls_follows_the_table() {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/notes/controls.md");
        let page = std::fs::read_to_string(&path).expect("the page");
        let (start, end) = ("| key | does |\n|---|---|\n", "\n\n");
        let (before, rest) = page.split_once(start).expect("a table");
        let (table, after) = rest.split_once(end).expect("text after the table");
        let rows = help(&Bindings::default());
        let rows: Vec<String> = rows
            .iter()
            .map(|(keys, does)| format!("| {keys} | {does} |"))
            .collect();
        let wanted = rows.join("\n");
        if std::env::var_os("GROTTO_UPDATE").is_some() {
            std::fs::write(&path, format!("{before}{start}{wanted}{end}{after}")).expect("written");
            return;
        }
        assert_eq!(table, wanted, "GROTTO_UPDATE=1 writes it");
    }
}
