//! What a user can do to a run: one value for each input, whether it comes from the window or from a record.
//!
//! The window translates its events into these values, and [`super::run::Run::take`] applies them. Nothing else
//! moves the player or changes voxels, so a record of these values is a record of the run.

use serde::{Deserialize, Serialize};

use super::hands::brush::{Brush, Stroke};

/// A key that moves the player.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Key {
    Forward,
    Back,
    Left,
    Right,
    /// Jump; rise in flight. Twice quickly: begin or end flight.
    Up,
    /// Sneak; sink in flight.
    Down,
    Run,
    /// Begin or end flight.
    Fly,
    /// Begin or end passing through voxels.
    NoClip,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Input {
    Press(Key),
    Release(Key),
    /// Pixels that the mouse moved, right and down, after the user's sensitivity: ten of them are a degree.
    Look(f32, f32),
    /// The user's field of view (degrees); `None`: that of the world's cameras.
    FieldOfView(Option<f32>),
    /// Notches of the mouse wheel, away from the user.
    Wheel(f32),
    /// A click, at what the crosshair points at.
    Stroke(Stroke),
    /// The button of a stroke goes down: the stroke is made, and made again while the button is held.
    Hold(Stroke),
    /// The button of a stroke goes up.
    LetGo(Stroke),
    /// The last stroke is undone.
    Undo,
    /// The stroke that was undone last is made again.
    Redo,
    /// The brush was changed in the panel.
    Brush(Brush),
    /// Jump to the world's camera of this index.
    Camera(usize),
    /// World time was paused, resumed, sped up or set.
    Clock {
        paused: bool,
        rate: f32,
        time_s: f64,
    },
    /// A parameter was set, as `KEY=VALUE`.
    Set(String),
    /// Another layout of probes was chosen.
    Layout(String),
    /// The picture has this size (pixels).
    Resize([u32; 2]),
    /// The window got or lost the keyboard.
    Focus(bool),
    /// The world file was read again.
    Reload,
}
