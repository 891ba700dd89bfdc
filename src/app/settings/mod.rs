//! Settings of the window that stay from run to run: what they are, and how a file of them is read.
//!
//! They are the user's, not the run's: a record holds what they led to (degrees that were looked, a field of view, a
//! parameter), so a replay needs none of them. Commands without a window never read them. `file` keeps them.

mod file;

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::{controls::Bindings, quality::Quality, texts::settings_file};
use crate::parameters::{Parameters, SCALES};

pub use file::Store;

/// Version of the file.
const VERSION: u64 = 1;

/// What a user set for all runs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Preferences {
    /// How far the view turns by a movement of the mouse, relative to 0.1° per pixel.
    pub mouse_sensitivity: f32,
    /// The view goes down when the mouse goes up.
    pub invert_y: bool,
    /// Vertical field of view (degrees); `None`: that of the world's camera.
    pub field_of_view_deg: Option<f32>,
    pub vsync: bool,
    /// Most frames per second; `None`: as many as there can be.
    pub frame_limit: Option<u32>,
    /// Most frames per second of a window that is not in use.
    pub unfocused_limit: u32,
    /// Size of letters and buttons.
    pub ui_scale: f32,
    pub full_screen: bool,
    /// Width and height of the window (pixels).
    pub window_size: [u32; 2],
    /// Brightness of the picture (stops).
    pub exposure_ev: f32,
    pub textures: bool,
    /// Edge length of the rendered picture, as a share of the window's; `None`: as it suits the adapter.
    pub picture_scale: Option<f32>,
    /// Loudness, 0 to 1.
    pub volume: f32,
    pub muted: bool,
    /// How much work a picture gets.
    pub quality: Quality,
    #[serde(skip)]
    pub keys: Bindings,
}

pub const SENSITIVITIES: RangeInclusive<f32> = 0.05..=5.0;
pub const FIELDS_OF_VIEW_DEG: RangeInclusive<f32> = 60.0..=120.0;
pub const FRAME_LIMITS: RangeInclusive<u32> = 30..=500;
pub const UNFOCUSED_LIMITS: RangeInclusive<u32> = 1..=500;
pub const UI_SCALES: RangeInclusive<f32> = 0.5..=3.0;
pub const EXPOSURES_EV: RangeInclusive<f32> = -4.0..=4.0;
pub const VOLUMES: RangeInclusive<f32> = 0.0..=1.0;
const WINDOW_EDGES: RangeInclusive<u32> = 64..=16_384;

impl Default for Preferences {
    fn default() -> Self {
        let parameters = Parameters::default();
        Self {
            mouse_sensitivity: 1.0,
            invert_y: false,
            field_of_view_deg: None,
            vsync: true,
            frame_limit: None,
            unfocused_limit: 10,
            ui_scale: 1.0,
            full_screen: false,
            window_size: [1280, 720],
            exposure_ev: parameters.picture.exposure_ev,
            textures: parameters.textures.enabled,
            picture_scale: None,
            volume: 0.8,
            muted: false,
            quality: Quality::default(),
            keys: Bindings::default(),
        }
    }
}

/// Why a file holds no settings.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    #[error(transparent)]
    Json(#[from] serde_json::Error),
    #[error("it has no `version`")]
    NoVersion,
}

/// Settings that were read.
#[derive(Debug)]
pub struct Read {
    pub preferences: Preferences,
    /// What of the file was not taken, in words.
    pub notes: Vec<String>,
    /// A newer grotto wrote the file: this one would lose some of it by writing.
    pub is_newer: bool,
}

impl Preferences {
    /// Reads the text of a file. Keys that are not known are ignored; values that cannot be are replaced, and noted.
    ///
    /// # Errors
    /// [`ReadError`] for a text that holds no settings.
    pub fn read(text: &str) -> Result<Read, ReadError> {
        let mut given: Map<String, Value> = serde_json::from_str(text)?;
        let version = given.remove("version").and_then(|known| known.as_u64());
        let version = version.ok_or(ReadError::NoVersion)?;
        let (keys, mut notes) = match given.remove("keys").map(serde_json::from_value) {
            Some(Ok(changed)) => Bindings::with(&changed),
            Some(Err(error)) => (Bindings::default(), vec![format!("`keys`: {error}")]),
            None => Default::default(),
        };
        let mut taken = Self::default().fields();
        for (name, value) in given {
            let Some(place) = taken.get_mut(&name) else {
                continue;
            };
            let before = std::mem::replace(place, value);
            let tried = serde_json::from_value::<Self>(Value::Object(taken.clone()));
            if let Err(error) = tried {
                let wrong = settings_file::wrong(&name, &error.to_string(), &before.to_string());
                notes.push(wrong);
                taken.insert(name, before);
            }
        }
        let mut preferences: Self = serde_json::from_value(Value::Object(taken))?;
        preferences.keys = keys;
        preferences.clamp(&mut notes);
        Ok(Read {
            preferences,
            notes,
            is_newer: version > VERSION,
        })
    }

    /// The text of a file.
    ///
    /// # Errors
    /// None of these values has any.
    pub fn text(&self) -> Result<String, serde_json::Error> {
        let mut fields = self.fields();
        fields.insert("version".to_owned(), VERSION.into());
        fields.insert(
            "keys".to_owned(),
            serde_json::to_value(self.keys.changed())?,
        );
        Ok(serde_json::to_string_pretty(&fields)? + "\n")
    }

    /// All but the keys, by name.
    fn fields(&self) -> Map<String, Value> {
        match serde_json::to_value(self) {
            Ok(Value::Object(fields)) => fields,
            _ => Map::new(),
        }
    }

    /// Moves every value into its range.
    fn clamp(&mut self, notes: &mut Vec<String>) {
        let Self {
            mouse_sensitivity,
            field_of_view_deg,
            frame_limit,
            unfocused_limit,
            ui_scale,
            window_size: [width, height],
            exposure_ev,
            picture_scale,
            volume,
            ..
        } = self;
        let given = |name, value: &mut Option<_>, range| {
            value.as_mut().and_then(|value| clamp(name, value, &range))
        };
        notes.extend(given(
            "field_of_view_deg",
            field_of_view_deg,
            FIELDS_OF_VIEW_DEG,
        ));
        notes.extend(given("picture_scale", picture_scale, SCALES));
        let limit = frame_limit.as_mut();
        notes.extend(limit.and_then(|limit| clamp("frame_limit", limit, &FRAME_LIMITS)));
        for (name, value, range) in [
            ("mouse_sensitivity", mouse_sensitivity, SENSITIVITIES),
            ("ui_scale", ui_scale, UI_SCALES),
            ("exposure_ev", exposure_ev, EXPOSURES_EV),
            ("volume", volume, VOLUMES),
        ] {
            notes.extend(clamp(name, value, &range));
        }
        for (name, value, range) in [
            ("unfocused_limit", unfocused_limit, UNFOCUSED_LIMITS),
            ("window_size", width, WINDOW_EDGES),
            ("window_size", height, WINDOW_EDGES),
        ] {
            notes.extend(clamp(name, value, &range));
        }
    }

    /// What a movement of the mouse (pixels right, down) looks like to the player.
    pub fn look(&self, (right, down): (f64, f64)) -> (f32, f32) {
        let sensitivity = self.mouse_sensitivity;
        let down = if self.invert_y { -down } else { down };
        (right as f32 * sensitivity, down as f32 * sensitivity)
    }

    /// Sets what the user changed about the picture, except parameters that the command line has set (`KEY=VALUE`).
    pub fn apply_to(&self, parameters: &mut Parameters, set: &[String]) {
        let first = Self::default();
        let is_set = |key: &str| {
            let key_of =
                |assignment: &String| assignment.split('=').next().map(str::trim) == Some(key);
            set.iter().any(key_of)
        };
        if self.exposure_ev != first.exposure_ev && !is_set("picture.exposure_ev") {
            parameters.picture.exposure_ev = self.exposure_ev;
        }
        if let Some(scale) = self.picture_scale
            && !is_set("picture.scale")
        {
            parameters.picture.scale = scale;
        }
        if self.textures != first.textures && !is_set("textures.enabled") {
            parameters.textures.enabled = self.textures;
        }
    }
}

/// Moves a value into its range. Returns a word about it if it was outside.
fn clamp<T>(name: &str, value: &mut T, range: &RangeInclusive<T>) -> Option<String>
where
    T: Copy + PartialOrd + std::fmt::Display,
{
    let clamped = if *value < *range.start() {
        *range.start()
    } else if *value > *range.end() {
        *range.end()
    } else {
        return None;
    };
    let given = std::mem::replace(value, clamped);
    let range = [range.start(), range.end()].map(ToString::to_string);
    Some(settings_file::clamped(
        name,
        [&range[0], &range[1]],
        &given.to_string(),
        &clamped.to_string(),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::{controls::Action, quality::Preset};

    fn changed() -> Preferences {
        let mut preferences = Preferences {
            mouse_sensitivity: 0.35,
            invert_y: true,
            field_of_view_deg: Some(95.0),
            vsync: false,
            frame_limit: Some(144),
            unfocused_limit: 5,
            ui_scale: 1.5,
            full_screen: true,
            window_size: [800, 600],
            exposure_ev: -1.5,
            textures: false,
            picture_scale: Some(0.5),
            volume: 0.25,
            muted: true,
            quality: Quality {
                preset: Some(Preset::Low),
                auto: false,
            },
            ..Preferences::default()
        };
        let key = "F".parse().expect("a key");
        preferences.keys.bind(Action::Fly, 0, key);
        preferences
    }

    #[test]
    fn settings_are_read_as_they_were_written() {
        for preferences in [Preferences::default(), changed()] {
            let read = Preferences::read(&preferences.text().expect("text")).expect("settings");
            assert_eq!(read.preferences, preferences);
            assert_eq!((read.notes.len(), read.is_newer), (0, false));
        }
        let default = Preferences::default().fields();
        for (name, value) in changed().fields() {
            assert_ne!(value, default[&name], "{name} is not tried");
        }
    }

    #[test]
    fn what_cannot_be_is_replaced_and_said_and_what_is_unknown_ignored() {
        let text = r#"{"version": 1, "shoes": 3, "vsync": "often", "volume": 7, "frame_limit": 2, "ui_scale": -1e9,
            "field_of_view_deg": 119.5, "unfocused_limit": -4, "window_size": [0, 700], "muted": true,
            "keys": {"fly": ["Q", "Esc"], "dance": ["D"]}}"#;
        let Read {
            preferences,
            notes,
            is_newer,
        } = Preferences::read(text).expect("settings");
        let wanted = Preferences {
            volume: 1.0,
            frame_limit: Some(30),
            ui_scale: 0.5,
            field_of_view_deg: Some(119.5),
            window_size: [64, 700],
            muted: true,
            keys: preferences.keys.clone(),
            ..Preferences::default()
        };
        assert_eq!(preferences, wanted);
        assert_eq!(preferences.keys.names(Action::Fly), "Q");
        assert_eq!(notes.len(), 7, "{notes:#?}");
        let told = |part: &str| notes.iter().any(|note| note.contains(part));
        for part in [
            "`vsync`",
            "`Esc`",
            "30 to 500: 2 became 30",
            "`unfocused_limit`",
        ] {
            assert!(told(part), "{part}: {notes:#?}");
        }
        assert!(!is_newer);
        let newer = Preferences::read(r#"{"version": 2, "muted": true}"#).expect("settings");
        assert!(newer.is_newer && newer.preferences.muted);
    }

    #[test]
    fn nonsense_is_refused() {
        for text in [
            "",
            "{",
            "[1]",
            "null",
            "\u{0}\u{1}",
            "{}",
            r#"{"version": "one"}"#,
        ] {
            assert!(Preferences::read(text).is_err(), "{text}");
        }
        let cut = &changed().text().expect("text")[..90];
        assert!(Preferences::read(cut).is_err());
    }

    #[test]
    fn the_mouse_is_scaled_and_turned_over() {
        let mut preferences = Preferences::default();
        assert_eq!(preferences.look((3.0, -2.0)), (3.0, -2.0));
        preferences.mouse_sensitivity = 2.0;
        preferences.invert_y = true;
        assert_eq!(preferences.look((3.0, -2.0)), (6.0, 4.0));
    }

    #[test]
    fn the_command_line_and_the_world_come_before_what_was_never_set() {
        let mut parameters = Parameters::default();
        parameters.picture.exposure_ev = 2.0;
        Preferences::default().apply_to(&mut parameters, &[]);
        assert_eq!(parameters.picture.exposure_ev, 2.0);
        changed().apply_to(&mut parameters, &["picture.exposure_ev=2".to_owned()]);
        assert_eq!(parameters.picture.exposure_ev, 2.0);
        assert!(!parameters.textures.enabled);
        changed().apply_to(&mut parameters, &[]);
        assert_eq!(parameters.picture.exposure_ev, -1.5);
    }
}
